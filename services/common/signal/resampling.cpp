#include "sealwatch/signal/resampling.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "sealwatch/signal/statistics.hpp"

namespace sealwatch::signal {
namespace {

// A sample this near to a grid time (in intervals) lies on it: times are printed with a few digits only.
constexpr double kOnGrid = 1e-3;
// Four samples further apart than this many intervals on average are no basis for a cubic.
constexpr double kLargestCubicSpan = 4.5;
// Share of a sample's deviation by which the sampling clock is corrected.
constexpr double kClockGain = 0.1;
// A grid of more rows is not counted: nobody could hold it.
constexpr double kMostRows = 1e15;

struct Points {
  std::vector<double> time_s;
  std::vector<double> value;
};

Points finite_points(std::span<const double> times_s, std::span<const double> values) {
  Points points;
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    points.time_s.push_back(times_s[i]);
    points.value.push_back(values[i]);
  }
  return points;
}

/// Usual interval: the mean of those that are not longer than one and a half of the median.
double usual_interval(std::span<const double> times_s) {
  std::vector<double> intervals(times_s.size() - 1);
  for (std::size_t i = 0; i < intervals.size(); ++i) intervals[i] = times_s[i + 1] - times_s[i];
  const double limit = 1.5 * median(intervals);
  double sum = 0.0;
  double count = 0.0;
  for (const double interval : intervals) {
    if (interval > limit) continue;
    sum += interval;
    count += 1.0;
  }
  return sum / count;
}

/// Grid intervals from each sample to the next. They are counted from a clock that follows the samples slowly, not from
/// the last sample, whose own jitter would add to the next one's.
std::vector<double> count_steps(std::span<const double> times_s) {
  const double usual = usual_interval(times_s);
  std::vector<double> steps(times_s.size() - 1);
  double clock_s = times_s.front();
  for (std::size_t i = 0; i < steps.size(); ++i) {
    steps[i] = std::max(1.0, std::round((times_s[i + 1] - clock_s) / usual));
    clock_s += steps[i] * usual;
    clock_s += kClockGain * (times_s[i + 1] - clock_s);
  }
  return steps;
}

/// Lagrange polynomial through points first..first+3.
double cubic(const Points& points, std::size_t first, double time_s) {
  double sum = 0.0;
  for (std::size_t i = first; i < first + 4; ++i) {
    double weight = 1.0;
    for (std::size_t j = first; j < first + 4; ++j)
      if (j != i) weight *= (time_s - points.time_s[j]) / (points.time_s[i] - points.time_s[j]);
    sum += weight * points.value[i];
  }
  return sum;
}

/// Value between points before and before+1.
double between(const Points& points, std::size_t before, double time_s, double interval_s) {
  const bool neighbours = before > 0 && before + 2 < points.time_s.size();
  if (neighbours && points.time_s[before + 2] - points.time_s[before - 1] < kLargestCubicSpan * interval_s)
    return cubic(points, before - 1, time_s);
  const double share = (time_s - points.time_s[before]) / (points.time_s[before + 1] - points.time_s[before]);
  return points.value[before] + share * (points.value[before + 1] - points.value[before]);
}

}  // namespace

SamplingGrid find_grid(std::span<const double> times_s) {
  assert(times_s.size() >= 2);
  const std::vector<double> steps = count_steps(times_s);
  double count = 0.0;
  for (const double step : steps) count += step;
  SamplingGrid grid{.begin_s = times_s.front(), .interval_s = (times_s.back() - times_s.front()) / count};
  grid.count = count < kMostRows ? static_cast<std::size_t>(count) + 1 : std::numeric_limits<std::size_t>::max();
  grid.missing_count = grid.count - times_s.size();
  double square = 0.0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const double excess = times_s[i + 1] - times_s[i] - steps[i] * grid.interval_s;
    square += excess * excess;
  }
  grid.jitter_std_s = std::sqrt(square / static_cast<double>(steps.size()));
  return grid;
}

std::vector<double> resample(std::span<const double> times_s, std::span<const double> values, const SamplingGrid& grid,
                             Interpolation interpolation, double shift_s) {
  const Points points = finite_points(times_s, values);
  std::vector<double> result(grid.count, 0.0);
  if (points.value.empty()) return result;
  const double near = kOnGrid * grid.interval_s;
  std::size_t before = 0;
  for (std::size_t k = 0; k < grid.count; ++k) {
    const double time = grid.time_s(k) + shift_s;
    while (before + 1 < points.time_s.size() && points.time_s[before + 1] <= time + near) ++before;
    const bool beyond_end = before + 1 == points.time_s.size();
    if (time <= points.time_s[before] + near || beyond_end || interpolation == Interpolation::hold)
      result[k] = points.value[before];
    else
      result[k] = between(points, before, time, grid.interval_s);
  }
  return result;
}

}  // namespace sealwatch::signal
