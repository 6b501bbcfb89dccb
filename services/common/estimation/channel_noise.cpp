#include "services/common/estimation/channel_noise.hpp"

#include "sealwatch/estimation/noise_floor.hpp"

namespace sealwatch {

double noise_std_of(const AssetConfig& asset, const Series& channel) {
  if (channel.noise_std > 0.0) return channel.noise_std;
  const double seen = estimate_noise_floor(channel.values).standard_deviation;
  if (seen > 0.0) return seen;
  const auto sensor = asset.sensors.find(channel.name);
  return sensor == asset.sensors.end() ? 0.0 : sensor->second.noise_std;
}

double time_constant_of(const AssetConfig& asset, const std::string& channel) {
  const auto sensor = asset.sensors.find(channel);
  return sensor == asset.sensors.end() ? 0.0 : sensor->second.time_constant_s;
}

}  // namespace sealwatch
