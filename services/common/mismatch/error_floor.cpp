#include "services/common/mismatch/error_floor.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "services/common/estimation/channel_noise.hpp"

namespace sealwatch::mismatch {

ChannelScales spread_of(const Data& data) {
  std::map<std::string, std::array<double, 3>> sums;  // count, sum, squares
  for (const TimeSeries& samples : data.samples)
    for (const Series& channel : samples.channels)
      for (const double value : channel.values) {
        auto& [count, sum, squares] = sums[channel.name];
        count += 1.0, sum += value, squares += value * value;
      }
  ChannelScales spread;
  for (const auto& [name, sum] : sums)
    spread[name] = std::sqrt(std::max(0.0, sum[2] / sum[0] - std::pow(sum[1] / sum[0], 2)));
  return spread;
}

Data with_error_floor(const AssetConfig& asset, Data data, const ChannelScales& spread) {
  data.colour.clear();
  data.start_as_measured = true;  // or a start far from it makes up for what the model lacks
  for (TimeSeries& samples : data.samples)
    for (Series& channel : samples.channels)
      channel.noise_std = std::max(noise_std_of(asset, channel, samples.time_s), kErrorFloor * spread.at(channel.name));
  return data;
}

Data one_of(const Data& data, std::size_t k) {
  return {.names = {data.names[k]},
          .samples = {data.samples[k]},
          .colour = {},
          .groups = {},
          .resolution = 0.0,
          .start_as_measured = data.start_as_measured};
}

Data all_but(const Data& data, std::size_t k) {
  Data rest = data;
  rest.names.erase(rest.names.begin() + static_cast<std::ptrdiff_t>(k));
  rest.samples.erase(rest.samples.begin() + static_cast<std::ptrdiff_t>(k));
  return rest;
}

double rms_in_noise(const FittedModel& model, const AssetConfig& asset, const Data& data) {
  double squares = 0.0, count = 0.0;
  for (std::size_t k = 0; k < data.samples.size(); ++k) {
    const PemRecording& part = model.problem.recordings[k];
    for (Eigen::Index c = 0; c < part.noise_std.size(); ++c) {
      Series channel = *data.samples[k].find(part.simulation->channels()[static_cast<std::size_t>(c)]);
      const double noise_std = noise_std_of(asset, channel, data.samples[k].time_s);
      const auto difference = part.simulation->recorded().col(c) - model.optimum.at_optimum[k].simulated.col(c);
      if (noise_std > 0.0) squares += difference.squaredNorm() / (noise_std * noise_std);
      count += static_cast<double>(difference.size());
    }
  }
  return std::sqrt(squares / std::max(count, 1.0));
}

}  // namespace sealwatch::mismatch
