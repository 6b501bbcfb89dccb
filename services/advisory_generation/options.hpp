// Settings of the advice, each with its reason. docs/advisories.md has the decision table that they belong to.
#pragma once

#include <cstddef>

#include "sealwatch/core/result.hpp"

namespace sealwatch::advisory_generation {

struct Options {
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
};

}  // namespace sealwatch::advisory_generation
