// The history that forecasters work on: one estimate of the seal condition per usable test.
#pragma once

#include <span>
#include <vector>

#include "sealwatch/core/time.hpp"

namespace sealwatch::forecast {

struct ConditionSample {
  UtcTime time;
  double condition = 0.0;      ///< theta, the leakage-derived index [1]
  double condition_std = 0.0;  ///< PEM's standard error of theta [1]; 0 when not known
  friend bool operator==(const ConditionSample&, const ConditionSample&) = default;
};

/// Marks months that cannot be believed by themselves. A sample is an outlier when it is further than five robust
/// standard deviations from the line (Theil-Sen) through the up to twelve tests nearest to it in time, the scatter of
/// those about their line being 1.4826 times the median absolute deviation, at least the median standard error. Two
/// neighbouring samples out on the same side confirm each other and both stand: a real jump is believed with the second
/// test that shows it. What is
/// off by less than 0.01, a fortieth of the way from new to failed, is never worth leaving out, and the first six tests
/// of a seal, where ageing is fastest, are not judged. `history` must be in the order of time.
[[nodiscard]] std::vector<bool> isolated_outliers(std::span<const ConditionSample> history);

}  // namespace sealwatch::forecast
