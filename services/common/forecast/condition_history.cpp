#include "sealwatch/forecast/condition_history.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace sealwatch::forecast {
namespace {

constexpr std::size_t kNeighbours = 12;   // a year of monthly tests: the line bends little within it
constexpr std::size_t kFewestBefore = 6;  // below, the median absolute deviation says nothing
// With twelve neighbours the robust deviation itself is good to about a quarter; five of it keep false marks below 1 in
// 200.
constexpr double kOutlierLimit = 5.0;
constexpr double kSmallestDeviation = 0.01;
constexpr double kNormalFromMedianDeviation = 1.4826;
constexpr double kSmallestScatter = 1e-6;  // rounding of histories in text files

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<ConditionSample> nearest_in_time(std::span<const ConditionSample> history, std::size_t index) {
  std::size_t first = index;
  std::size_t last = index;  // inclusive
  while (last - first < std::min(kNeighbours, history.size() - 1)) {
    const bool can_go_back = first > 0;
    const bool can_go_on = last + 1 < history.size();
    const bool back_is_nearer =
        can_go_back && (!can_go_on || seconds_between(history[first - 1].time, history[index].time) <=
                                          seconds_between(history[index].time, history[last + 1].time));
    back_is_nearer ? --first : ++last;
  }
  std::vector<ConditionSample> neighbours;
  for (std::size_t i = first; i <= last; ++i)
    if (i != index) neighbours.push_back(history[i]);
  return neighbours;
}

/// Deviation of the sample from its neighbours' line in robust standard deviations.
double deviation(std::span<const ConditionSample> history, std::size_t index) {
  if (index < kFewestBefore) return 0.0;
  const std::vector<ConditionSample> neighbours = nearest_in_time(history, index);

  std::vector<double> slopes;  // per month
  for (std::size_t i = 0; i < neighbours.size(); ++i)
    for (std::size_t j = i + 1; j < neighbours.size(); ++j)
      if (neighbours[j].time > neighbours[i].time)
        slopes.push_back((neighbours[j].condition - neighbours[i].condition) /
                         months_between(neighbours[i].time, neighbours[j].time));
  const double slope = slopes.empty() ? 0.0 : median(slopes);
  const auto detrended = [&](const ConditionSample& sample) {
    return sample.condition - slope * months_between(history[index].time, sample.time);
  };
  std::vector<double> levels;
  std::vector<double> standard_errors;
  for (const ConditionSample& neighbour : neighbours) {
    levels.push_back(detrended(neighbour));
    standard_errors.push_back(neighbour.condition_std);
  }
  const double level = median(levels);
  for (double& value : levels) value = std::abs(value - level);
  const double scatter =
      std::max({kNormalFromMedianDeviation * median(levels), median(standard_errors), kSmallestScatter});
  const double off = history[index].condition - level;
  if (std::abs(off) < kSmallestDeviation) return 0.0;
  return off / std::hypot(scatter, history[index].condition_std);
}

}  // namespace

std::vector<bool> isolated_outliers(std::span<const ConditionSample> history) {
  std::vector<double> deviations;
  for (std::size_t i = 0; i < history.size(); ++i) deviations.push_back(deviation(history, i));
  const auto out_on_same_side = [&](std::size_t i, std::size_t j) {
    return std::abs(deviations[j]) > kOutlierLimit && (deviations[i] > 0.0) == (deviations[j] > 0.0);
  };
  std::vector<bool> outlier(history.size(), false);
  for (std::size_t i = 0; i < history.size(); ++i) {
    const bool confirmed =
        (i > 0 && out_on_same_side(i, i - 1)) || (i + 1 < history.size() && out_on_same_side(i, i + 1));
    outlier[i] = std::abs(deviations[i]) > kOutlierLimit && !confirmed;
  }
  return outlier;
}

}  // namespace sealwatch::forecast
