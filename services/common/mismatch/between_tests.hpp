// Whether the recordings differ from one another rather than from the model: each alone agrees with it, all together do
// not, because a parameter (a seal that ages) changed between the tests.
//
//   sum_i misfit_i / phi + sum_i k_i ln N  <  misfit / phi + k ln N,   phi = max(1, sum_i misfit_i / N)
//
// i: a recording, held out or not, fitted by itself with k_i free parameters; right: the laws found with k free
// parameters, fitted to the fit recordings together, of which nothing but load and initial state is fitted to the
// held-out ones. Parameters of its own for each test must be likelier than laws in common: where the laws are right,
// they cost less. The held-out recordings can so take a claim back, never make one: of two tests of an ageing seal laws
// in common can still take the difference, a third shows that it was not theirs.
#pragma once

#include <optional>
#include <string>

#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// The parameter that changed, in one sentence; nothing where one of the recordings disagrees with the model by itself,
/// or where `best`, fitted to those of `fit`, is likelier.
[[nodiscard]] std::optional<std::string> change_between_tests(const AssetConfig& asset, const Data& fit,
                                                              const Data& holdout, const FittedModel& best);

}  // namespace sealwatch::mismatch
