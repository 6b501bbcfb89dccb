#include "services/common/model/first_value.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace sealwatch {
namespace {

double mean_of(const std::vector<double>& values, std::size_t count) {
  return std::accumulate(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count), 0.0) /
         static_cast<double>(count);
}

/// Noise of a channel that does not say its own: of third differences, which a parabola has none of.
double scatter_of(const Series& series) {
  if (series.noise_std > 0.0) return series.noise_std;
  const std::vector<double>& y = series.values;
  if (y.size() < 4) return 0.0;
  std::vector<double> differences;
  for (std::size_t k = 0; k + 3 < y.size(); ++k)
    differences.push_back(std::abs(y[k + 3] - y[k] - 3.0 * (y[k + 2] - y[k + 1])));
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::ranges::nth_element(differences, middle);
  return 1.4826 * *middle / std::sqrt(20.0);
}

}  // namespace

std::optional<double> first_value(const TimeSeries& recorded, std::string_view channel) {
  const Series* series = recorded.find(channel);
  if (series == nullptr || series->values.empty()) return std::nullopt;
  constexpr std::size_t kMost = 3;
  constexpr double kSurely = 3.0;      // standard deviations
  constexpr double kRounding = 1e-12;  // of a sum of equal values
  const double scatter = scatter_of(*series);
  double believed = series->values.front();
  for (std::size_t count = 2; count <= std::min(kMost, series->values.size()); ++count) {
    const double mean = mean_of(series->values, count);
    for (std::size_t fewer = 1; fewer < count; ++fewer) {
      const double spread = std::sqrt(1.0 / static_cast<double>(fewer) - 1.0 / static_cast<double>(count));
      if (std::abs(mean - mean_of(series->values, fewer)) > kSurely * scatter * spread + kRounding * std::abs(mean))
        return believed;
    }
    believed = mean;
  }
  return believed;
}

std::optional<double> mean_value(const TimeSeries& recorded, std::string_view channel) {
  const Series* series = recorded.find(channel);
  if (series == nullptr) return std::nullopt;
  return mean_of(series->values, series->values.size());
}

}  // namespace sealwatch
