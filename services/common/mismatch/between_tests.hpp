// What changed from test to test, which laws in common would be bent to explain.
//
// Each recording alone agrees with the model, all together do not, because a parameter changed between the tests:
//
//   sum_i misfit_i / phi + sum_i k_i ln N  <  misfit / phi + k ln N,   phi = max(1, sum_i misfit_i / N)
//
// i: a recording, held out or not, fitted by itself with k_i free parameters; right: the laws found with k free
// parameters, fitted to the fit recordings together, of which nothing but load and initial state is fitted to the
// held-out ones. Parameters of its own for each test must be likelier than laws in common: where the laws are right,
// they cost less. The held-out recordings can so take a claim back, never make one: of two tests of an ageing seal laws
// in common can still take the difference, a third shows that it was not theirs.
//
// A seal that ages while physics is missing: each recording keeps a leakage resistance R_CL of its own, and laws are
// asked for beside it. That model must be likelier by the same rule (a parameter more for each recording), and R_CL
// fall from test to test: wear does not heal. Only tests of different days are asked: within one a seal does not age.
#pragma once

#include <optional>
#include <string>

#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// What is said of a parameter that changed, and the element that it belongs to ("" where it belongs to several).
struct ChangeBetweenTests {
  std::string sentence;
  std::string element;
};

/// Nothing where one of the recordings disagrees with the model by itself, or where `best`, fitted to those of `fit`,
/// is likelier.
[[nodiscard]] std::optional<ChangeBetweenTests> change_between_tests(const AssetConfig& asset, const Data& fit,
                                                                     const Data& holdout, const FittedModel& best);

/// Whether `asset` estimates a seal's leakage, and these recordings are of several days.
[[nodiscard]] bool seal_may_age(const AssetConfig& asset, const Data& fit);

/// Whether R_CL falls from recording to recording, by far more than its standard errors.
[[nodiscard]] bool seal_ages(const FittedModel& model, const Data& fit);

/// Whether `ageing` (its data say which parameter each recording has for itself) is likelier than `common` on all
/// recordings, those that were held out with it.
[[nodiscard]] bool ageing_is_likelier(const FittedModel& ageing, const Data& ageing_holdout, const FittedModel& common,
                                      const Data& common_holdout);

/// "R_CL fell from 2.1e+13 (2031-04-12) to ... Pa s/m3", value by value.
[[nodiscard]] std::string ageing_in_words(const FittedModel& model, const Data& fit);

}  // namespace sealwatch::mismatch
