#include "services/common/model/first_value.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace sealwatch {
namespace {

double mean_of(const std::vector<double>& values, std::size_t count) {
  return std::accumulate(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count), 0.0) /
         static_cast<double>(count);
}

}  // namespace

std::optional<double> first_value(const TimeSeries& recorded, std::string_view channel) {
  const Series* series = recorded.find(channel);
  if (series == nullptr || series->values.empty()) return std::nullopt;
  return mean_of(series->values, std::min<std::size_t>(3, series->values.size()));
}

std::optional<double> mean_value(const TimeSeries& recorded, std::string_view channel) {
  const Series* series = recorded.find(channel);
  if (series == nullptr) return std::nullopt;
  return mean_of(series->values, series->values.size());
}

}  // namespace sealwatch
