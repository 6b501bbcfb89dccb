#include "services/common/estimation/channel_noise.hpp"

#include "sealwatch/signal/noise_floor.hpp"

namespace sealwatch {

double noise_std_of(const AssetConfig& asset, const Series& channel, std::span<const double> time_s) {
  const auto sensor = asset.sensors.find(channel.name);
  return signal::believed_noise_std(channel, sensor == asset.sensors.end() ? 0.0 : sensor->second.noise_std, time_s);
}

double noise_std_of(const AssetConfig& asset, const Series& channel) { return noise_std_of(asset, channel, {}); }

double time_constant_of(const AssetConfig& asset, const std::string& channel) {
  const auto sensor = asset.sensors.find(channel);
  return sensor == asset.sensors.end() ? 0.0 : sensor->second.time_constant_s;
}

}  // namespace sealwatch
