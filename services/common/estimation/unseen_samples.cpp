#include "services/common/estimation/unseen_samples.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "sealwatch/model/driving_channels.hpp"
#include "services/common/estimation/channel_noise.hpp"

namespace sealwatch {
namespace {

constexpr double kHalfMean_s = 0.1;
constexpr double kTimesNoise = 4.0;  // of the mean: pauses are some thousands of samples

// Sign of the mean of the samples within kHalfMean_s; 0 where noise decides it.
std::vector<int> signs_of(const Series& input, const std::vector<double>& time_s, double noise_std) {
  std::vector<int> signs;
  std::size_t first = 0, end = 0;
  double sum = 0.0;
  for (const double now_s : time_s) {
    while (end < time_s.size() && time_s[end] <= now_s + kHalfMean_s) sum += input.values[end++];
    while (time_s[first] < now_s - kHalfMean_s) sum -= input.values[first++];
    const bool shows = std::abs(sum) > kTimesNoise * noise_std * std::sqrt(static_cast<double>(end - first));
    signs.push_back(shows ? (sum > 0.0 ? 1 : -1) : 0);
  }
  return signs;
}

}  // namespace

std::vector<Eigen::Index> unseen_samples(const AssetConfig& asset, const TimeSeries& recorded) {
  const PlantPart part = simulated_part(asset, recorded);
  const Series* input = part.inputs.empty() ? nullptr : recorded.find(part.inputs.front());
  if (!(part.unseen_at_reversal_s > 0.0) || input == nullptr) return {};
  const std::vector<double>& time_s = recorded.time_s;
  const std::vector<int> signs = signs_of(*input, time_s, noise_std_of(asset, *input, time_s));
  std::vector<Eigen::Index> samples;
  std::optional<std::size_t> last;
  std::size_t next = 0;  // that is not among them yet
  for (std::size_t k = 0; k < signs.size(); ++k) {
    if (signs[k] == 0) continue;
    if (last && signs[*last] != signs[k]) {
      const double from_s = time_s[*last] - part.unseen_at_reversal_s, until_s = time_s[k] + part.unseen_at_reversal_s;
      const auto begin = std::ranges::lower_bound(time_s, from_s), end = std::ranges::upper_bound(time_s, until_s);
      next = std::max(next, static_cast<std::size_t>(begin - time_s.begin()));
      for (; next < static_cast<std::size_t>(end - time_s.begin()); ++next)
        samples.push_back(static_cast<Eigen::Index>(next));
    }
    last = k;
  }
  return samples;
}

}  // namespace sealwatch
