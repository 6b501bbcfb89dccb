#include "sealwatch/signal/jumps.hpp"

#include <algorithm>
#include <cmath>

namespace sealwatch::signal {
namespace {

constexpr double kTimesTheScatter = 8.0;
constexpr std::size_t kNeighbours = 3;  // on either side

}  // namespace

std::vector<std::size_t> find_jumps(std::span<const double> values, double least) {
  std::vector<std::size_t> found;
  const auto change = [&](std::size_t k) { return values[k] - values[k - 1]; };
  for (std::size_t k = 1; k < values.size(); ++k) {
    const std::size_t begin = k > kNeighbours ? k - kNeighbours : 1, end = std::min(values.size(), k + kNeighbours + 1);
    if (end - begin <= kNeighbours) continue;  // of so few samples nobody can tell
    double mean = 0.0, scatter = least / kTimesTheScatter;
    for (std::size_t j = begin; j < end; ++j)
      if (j != k) mean += change(j) / static_cast<double>(end - begin - 1);
    for (std::size_t j = begin; j < end; ++j)
      if (j != k) scatter = std::max(scatter, std::abs(change(j) - mean));
    if (std::abs(change(k) - mean) > kTimesTheScatter * scatter) found.push_back(k);
  }
  return found;
}

}  // namespace sealwatch::signal
