// Whether the recordings differ from one another rather than from the model: laws in common would be bent to explain
// it. Each recording alone agrees with the model, all together do not, because a parameter changed between the tests:
//
//   sum_i misfit_i / phi + sum_i k_i ln N  <  misfit / phi + k ln N,   phi = max(1, sum_i misfit_i / N)
//
// i: a fitted recording by itself with k_i free parameters; right: the laws found with k free parameters, fitted to all
// of them together. Parameters of its own for each test must be likelier than laws in common: where the laws are right,
// they cost less.
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

/// Whether all recordings, which are in the order of time, have one, and more than a day lies between first and last.
[[nodiscard]] bool are_of_several_days(const Data& data);

/// Whether they are known to be of one day.
[[nodiscard]] bool are_of_one_day(const Data& data);

/// Standard errors by which a parameter must have changed.
inline constexpr double kChanged = 10.0;

/// Of one model on some recordings: sum of squares, residuals, free parameters.
struct Misfit {
  double sum = 0.0, residuals = 0.0, free = 0.0;
  [[nodiscard]] double criterion(double phi) const;
};

/// What is said of a parameter that changed, and the element that it belongs to ("" where it belongs to several).
struct ChangeBetweenTests {
  std::string sentence;
  std::string element;
};

/// Nothing where all are known to be of one day, where one of the recordings disagrees with the model by itself, or
/// where `best`, fitted to all of them, is likelier.
[[nodiscard]] std::optional<ChangeBetweenTests> change_between_tests(const AssetConfig& asset, const Data& fit,
                                                                     const FittedModel& best);

}  // namespace sealwatch::mismatch
