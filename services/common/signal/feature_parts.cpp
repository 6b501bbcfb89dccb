#include "services/common/signal/feature_parts.hpp"

#include <algorithm>
#include <cmath>

namespace sealwatch::signal {

std::optional<Estimate> pooled_mean(const std::vector<double>& values, const std::vector<Range>& ranges) {
  double count = 0.0, sum = 0.0, variance = 0.0;
  for (const Range& range : ranges) {
    const Estimate one = mean(part(values, range));
    const auto weight = static_cast<double>(range.size());
    count += weight;
    sum += weight * one.value;
    variance += weight * weight * one.std_error * one.std_error;
  }
  if (count == 0.0) return std::nullopt;
  return Estimate{sum / count, std::sqrt(variance) / count};
}

std::optional<double> crossing_s(const TestRecord& test, Range range, double level, double direction) {
  const std::vector<double>& x = test.position();
  for (std::size_t i = std::max<std::size_t>(range.begin, 1); i < range.end; ++i) {
    if (direction * (x[i - 1] - level) > 0.0 || direction * (x[i] - level) < 0.0) continue;
    const double share = x[i] == x[i - 1] ? 0.0 : (level - x[i - 1]) / (x[i] - x[i - 1]);
    return test.samples().time_s[i - 1] + share * test.interval_s();
  }
  return std::nullopt;
}

double saturation(const std::vector<double>& drive) {
  double largest = 0.0;
  for (const double value : drive) largest = std::max(largest, std::abs(value));
  if (largest == 0.0) return 0.0;
  std::size_t saturated = 0, elsewhere = 0;
  for (std::size_t i = 0, end = 0; i < drive.size(); i = end) {
    ++end;  // a run has one sample at least, whatever it compares like
    while (end < drive.size() && drive[end] == drive[i]) ++end;
    if (end - i < 5) continue;
    if (std::abs(drive[i]) >= largest)
      saturated += end - i;
    else if (drive[i] != 0.0)
      elsewhere += end - i;
  }
  // A program of set values stands still at others too: its largest is no end of a range.
  if (elsewhere >= saturated) return 0.0;
  return static_cast<double>(saturated) / static_cast<double>(drive.size());
}

Estimate peak(const std::vector<double>& values, double noise_std) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return {largest, noise_std};
}

}  // namespace sealwatch::signal
