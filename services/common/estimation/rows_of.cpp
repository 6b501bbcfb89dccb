#include "services/common/estimation/rows_of.hpp"

#include <vector>

namespace sealwatch {

TimeSeries rows_of(const TimeSeries& samples, std::size_t begin, std::size_t end, std::size_t step) {
  const auto cut = [&](const std::vector<double>& values) {
    std::vector<double> kept;
    kept.reserve((end - begin + step - 1) / step);
    for (std::size_t row = begin; row < end; row += step) kept.push_back(values[row]);
    return kept;
  };
  TimeSeries piece{.time_s = cut(samples.time_s), .channels = {}, .input_hold = samples.input_hold};
  for (const Series& channel : samples.channels)
    piece.channels.push_back({channel.name, channel.unit, channel.noise_std, cut(channel.values)});
  return piece;
}

}  // namespace sealwatch
