// Small pieces that features are made of.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "sealwatch/signal/statistics.hpp"
#include "sealwatch/signal/test_record.hpp"

namespace sealwatch::signal {

[[nodiscard]] inline std::span<const double> part(const std::vector<double>& values, Range range) {
  return std::span<const double>(values).subspan(range.begin, range.size());
}

/// Mean of several ranges' means, each weighted by its length; absent for no ranges.
[[nodiscard]] std::optional<Estimate> pooled_mean(const std::vector<double>& values, const std::vector<Range>& ranges);

/// Time at which the smoothed position first passes `level` in the range, by linear interpolation.
[[nodiscard]] std::optional<double> crossing_s(const TestRecord& test, Range range, double level, double direction);

/// Share of samples in runs of at least five that stand exactly at the largest magnitude: a limit, not a peak.
[[nodiscard]] double saturation(const std::vector<double>& drive);

/// Largest magnitude, known to the noise of one value.
[[nodiscard]] Estimate peak(const std::vector<double>& values, double noise_std);

}  // namespace sealwatch::signal
