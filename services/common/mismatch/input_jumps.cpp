#include "services/common/mismatch/input_jumps.hpp"

#include <algorithm>
#include <cmath>

namespace sealwatch::mismatch {
namespace {

constexpr double kTimesItsNeighbours = 8.0;
constexpr double kShareOfRange = 0.005;
constexpr std::size_t kNeighbours = 3;
constexpr std::size_t kSamplesAfter = 2;

bool jumps(const std::vector<double>& change, std::size_t at) {
  const std::size_t begin = at >= kNeighbours ? at - kNeighbours : 0,
                    end = std::min(change.size(), at + kNeighbours + 1);
  double around = 0.0;
  for (std::size_t k = begin; k < end; ++k)
    if (k != at) around = std::max(around, change[k]);
  return change[at] > kTimesItsNeighbours * around;
}

}  // namespace

std::vector<Eigen::Index> samples_after_jumps(const TimeSeries& recorded, const PlantDescription& plant) {
  std::vector<Eigen::Index> samples;
  const Series* input = find_series(recorded, plant, ChannelRole::drive);
  if (input == nullptr || input->unit != "V" || recorded.input_hold || input->values.size() < 2) return samples;
  const auto [lowest, highest] = std::ranges::minmax(input->values);
  const double least = kShareOfRange * (highest - lowest);
  std::vector<double> change;
  for (std::size_t k = 1; k < input->values.size(); ++k)
    change.push_back(std::abs(input->values[k] - input->values[k - 1]));
  for (std::size_t k = 0; k < change.size(); ++k) {
    if (!(change[k] > least) || !jumps(change, k)) continue;
    for (std::size_t after = k + 1; after < std::min(k + 1 + kSamplesAfter, input->values.size()); ++after)
      samples.push_back(static_cast<Eigen::Index>(after));
  }
  return samples;
}

}  // namespace sealwatch::mismatch
