// Standard errors of a fitted model's shared unknowns, also where it leaves more than noise.
//
//   A   = sum_i J_i' J_i / phi + P     J_i: whitened Jacobian of recording i by the shared unknowns, its own (load,
//                                      initial state) projected off; phi: criterion.hpp; P: 1 / sigma^2 of each value
//                                      that is known within sigma
//   s_b = J_b' r_b                     score of block b of neighbouring samples, r: whitened residual
//   B   = n / (n - 1) sum_b s_b s_b'   n blocks
//   variance = the larger of A^-1 and A^-1 (B / phi^2 + P) A^-1
//
// What a model misses grossly says nothing against what is known of a value: phi counts for the recordings alone.
// The second holds where a law's form is not quite that of the plant: what is left then is a course, which samples
// beside each other share, and counts once a block (White 1980, "sandwich"; Liang and Zeger 1986 for blocks). Neither
// knows of a bias that is the same in all blocks.
#pragma once

#include <span>
#include <vector>

#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// Of each shared unknown in its own unit; infinite where the data cannot tell or where the unknown is at its bound.
[[nodiscard]] std::vector<double> standard_errors(const FittedModel& model);

/// Of these shared unknowns where the `given` ones are known. A law's strength beside its own shape: whether the law is
/// there, when strength and shape can only be told together (k i |i| / (i_f + |i|), i_f beyond all currents).
[[nodiscard]] std::vector<double> standard_errors_beside(const FittedModel& model,
                                                         std::span<const std::size_t> unknowns,
                                                         std::span<const std::size_t> given);

/// Between the two of these shared unknowns that lie furthest apart, in standard errors of their difference: what is known
/// of neither, as both share it (a sensor's gain), says nothing against that. Values of one parameter in several
/// recordings; 0 where the data cannot tell one of them.
[[nodiscard]] double standard_errors_apart(const FittedModel& model, std::span<const std::size_t> unknowns);

}  // namespace sealwatch::mismatch
