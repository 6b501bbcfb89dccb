// Normal equations of a fitted model: those of all recordings together, shared unknowns first, then each recording's
// own. What is known of the unknowns beforehand is not in them.
#pragma once

#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

struct NormalEquations {
  Eigen::MatrixXd gram;      ///< J'J
  Eigen::VectorXd gradient;  ///< J'r
};

[[nodiscard]] NormalEquations normal_equations(const FittedModel& model);

}  // namespace sealwatch::mismatch
