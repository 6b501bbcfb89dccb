#include "services/common/estimation/rows_of.hpp"

#include <vector>

namespace sealwatch {

TimeSeries rows_of(const TimeSeries& samples, std::size_t begin, std::size_t end) {
  const auto cut = [&](const std::vector<double>& values) {
    return std::vector<double>(values.begin() + static_cast<std::ptrdiff_t>(begin),
                               values.begin() + static_cast<std::ptrdiff_t>(end));
  };
  TimeSeries piece{.time_s = cut(samples.time_s), .channels = {}, .input_hold = samples.input_hold};
  for (const Series& channel : samples.channels)
    piece.channels.push_back({channel.name, channel.unit, channel.noise_std, cut(channel.values)});
  return piece;
}

}  // namespace sealwatch
