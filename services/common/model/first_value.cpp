#include "services/common/model/first_value.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace sealwatch {
namespace {

constexpr std::size_t kStart = 3;  ///< samples whose mean is where a channel starts

double mean_of(const std::vector<double>& values, std::size_t count) {
  return std::accumulate(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count), 0.0) /
         static_cast<double>(count);
}

}  // namespace

std::optional<double> first_value(const TimeSeries& recorded, std::string_view channel) {
  const Series* series = recorded.find(channel);
  if (series == nullptr || series->values.empty()) return std::nullopt;
  return mean_of(series->values, std::min(kStart, series->values.size()));
}

void start_at_first_sample(Series& series) {
  const std::size_t count = std::min(kStart, series.values.size());
  if (count > 0) std::fill_n(series.values.begin(), count, series.values.front());
}

std::optional<double> mean_value(const TimeSeries& recorded, std::string_view channel) {
  const Series* series = recorded.find(channel);
  if (series == nullptr) return std::nullopt;
  return mean_of(series->values, series->values.size());
}

}  // namespace sealwatch
