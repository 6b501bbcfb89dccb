// What the misfit would lose, on the linearised model, if each recording had a value of its own of one parameter.
//
//   gain = b' A^-1 b,   A = sum_k J_k' J_k + P,   b = sum_k J_k' r_k + P (x - x_0)
//
// r_k: whitened residuals of recording k; J_k: their derivatives by the shared unknowns x, those by its own (load, initial
// state) projected off, the parameter's column only in recording k's place; P: 1 / sigma^2 of what is known within
// sigma of x_0. Unknowns at an end of their range stay there.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

struct OwnGain {
  std::string parameter;
  double gain = 0.0;
};

/// Of those `parameters` that the model has in common and estimates, the largest gain first. The model has its derivatives.
[[nodiscard]] std::vector<OwnGain> gains_of_own_values(const FittedModel& model,
                                                       std::span<const std::string> parameters);

}  // namespace sealwatch::mismatch
