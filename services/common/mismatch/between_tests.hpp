// Whether the recordings differ from one another rather than from the model: each alone agrees with it, all together do
// not, because a parameter (a seal that ages) changed between the tests.
//
//   sum_i misfit_i / phi + sum_i k_i ln N  <  misfit / phi + k ln N,   phi = max(1, sum_i misfit_i / N)
//
// i: a recording fitted by itself with k_i free parameters; right: all together with the laws found (k free
// parameters). Parameters of its own for each test must be likelier than laws in common: where the laws are right, they
// cost less.
#pragma once

#include <optional>
#include <string>

#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// The parameter that changed, in one sentence; nothing where one of the recordings disagrees with the model by itself,
/// or where `best`, fitted to all of them, is likelier.
[[nodiscard]] std::optional<std::string> change_between_tests(const AssetConfig& asset, const Data& data,
                                                              const FittedModel& best);

}  // namespace sealwatch::mismatch
