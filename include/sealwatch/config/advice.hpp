// Settings of the advice, each with its reason. docs/advisories.md has the decision table that they belong to;
// services.advisory_generation.advice in sealwatch.yaml sets them by these names.
#pragma once

#include <cstddef>
#include <string>

#include "sealwatch/core/fields.hpp"
#include "sealwatch/core/result.hpp"

namespace sealwatch {

struct AdviceOptions {
  /// Largest probability of failure before the campaign that replaces the seal. 10 %: the P10 end of life that
  /// operators see.
  double largest_failure_probability = 0.10;
  /// Planning starts this long before the last booking date: a year's budget round has to fall in between.
  double planning_horizon_months = 18.0;
  /// From this long before the last booking date on, the booking itself is due: two meetings of a vessel schedule.
  double booking_horizon_months = 6.0;
  /// A P10 end of life nearer than this leaves no test in between to wait for: the seal counts as gone.
  double urgent_months = 1.0;

  /// Money is spent (a vessel booked) only when the straight and the logarithmic law of ageing agree to this much: on
  /// seals of the reference recursion the end of life lies between them, 10 months apart in the last three years, 50
  /// before.
  double largest_law_gap_months = 24.0;

  /// A worse level is shown once `confirming_tests` of the last `confirming_window` judged tests ask for it or more ...
  std::size_t confirming_tests = 2;
  std::size_t confirming_window = 3;
  /// ... and given up once so many judged tests in a row ask for less: twice as slow, false comfort costs more.
  std::size_t easing_tests = 4;

  /// A latest-by date moves only when it changes by more than a month, the pace of the tests, ...
  double date_tolerance_months = 1.0;
  /// ... and by more than this share of the time that is left to it: far dates are vague.
  double date_tolerance_share = 0.10;

  /// A proposed fault is taken as the cause from this likelihood on: it outweighs all others together.
  double dominant_likelihood = 0.5;

  [[nodiscard]] Status validate() const;
  SEALWATCH_FIELDS(AdviceOptions, largest_failure_probability, planning_horizon_months, booking_horizon_months,
                   urgent_months, largest_law_gap_months, confirming_tests, confirming_window, easing_tests,
                   date_tolerance_months, date_tolerance_share, dominant_likelihood)
};

inline Status AdviceOptions::validate() const {
  const auto broken = [](const char* place, double value, const char* rule) {
    return Error{.file = {}, .place = place, .value = std::to_string(value), .rule = rule, .advice = {}};
  };
  if (!(largest_failure_probability > 0.0 && largest_failure_probability <= 0.5))
    return fail(broken("largest_failure_probability", largest_failure_probability, "must be above 0, at most 0.5"));
  if (!(booking_horizon_months > 0.0 && booking_horizon_months < planning_horizon_months))
    return fail(
        broken("booking_horizon_months", booking_horizon_months, "must be above 0, below planning_horizon_months"));
  if (!(urgent_months >= 0.0)) return fail(broken("urgent_months", urgent_months, "must not be negative"));
  if (!(largest_law_gap_months > 0.0))
    return fail(broken("largest_law_gap_months", largest_law_gap_months, "must be positive"));
  if (confirming_tests < 1 || confirming_tests > confirming_window)
    return fail(broken("confirming_tests", static_cast<double>(confirming_tests), "must be 1 to confirming_window"));
  if (easing_tests < confirming_window)
    return fail(broken("easing_tests", static_cast<double>(easing_tests), "must be at least confirming_window"));
  if (!(date_tolerance_months >= 0.0))
    return fail(broken("date_tolerance_months", date_tolerance_months, "must not be negative"));
  if (!(date_tolerance_share >= 0.0 && date_tolerance_share < 1.0))
    return fail(broken("date_tolerance_share", date_tolerance_share, "must be 0 to 1"));
  if (!(dominant_likelihood > 0.0 && dominant_likelihood <= 1.0))
    return fail(broken("dominant_likelihood", dominant_likelihood, "must be above 0, at most 1"));
  return {};
}

}  // namespace sealwatch
