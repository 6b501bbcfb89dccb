// Whether the recordings differ from one another rather than from the model: laws in common would be bent to explain
// it. Each recording alone agrees with the model, all together do not, because a parameter changed between the tests:
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

/// One parameter from recording to recording.
struct Course {
  struct Value {
    std::string when;  ///< the test's date, or its name
    double value = 0.0, std_error = 0.0;
  };
  std::string unit;
  std::vector<Value> values;

  /// Between the smallest and the largest value, in the largest of their standard errors.
  [[nodiscard]] double standard_errors() const;
  /// Each value with its test; of many the first, the last and how many lie between.
  [[nodiscard]] std::string in_words() const;
};

/// The date of a recording, or its name where it has none.
[[nodiscard]] std::string date_or_name(const Data& data, std::size_t recording);

/// Standard errors by which a parameter must have changed.
inline constexpr double kChanged = 10.0;

/// Of one model on some recordings: sum of squares, residuals, free parameters.
struct Misfit {
  double sum = 0.0, residuals = 0.0, free = 0.0;
  [[nodiscard]] double criterion(double phi) const;
};

/// Of the model with its laws on the recordings that it was fitted to and on held-out ones; nothing where it cannot be
/// simulated on one of these.
[[nodiscard]] std::optional<Misfit> misfit_in_common(const FittedModel& best, const Data& holdout);

/// What is said of a parameter that changed, and the element that it belongs to ("" where it belongs to several).
struct ChangeBetweenTests {
  std::string sentence;
  std::string element;
};

/// Nothing where one of the recordings disagrees with the model by itself, or where `best`, fitted to those of `fit`,
/// is likelier.
[[nodiscard]] std::optional<ChangeBetweenTests> change_between_tests(const AssetConfig& asset, const Data& fit,
                                                                     const Data& holdout, const FittedModel& best);

}  // namespace sealwatch::mismatch
