#include "services/common/estimation/channel_noise.hpp"

#include <algorithm>

#include "sealwatch/estimation/noise_floor.hpp"

namespace sealwatch {
namespace {

constexpr double kLeastShareOfSensor = 0.1;  // of the sensor's noise, that the data may seem to have

}  // namespace

double noise_std_of(const AssetConfig& asset, const Series& channel) {
  if (channel.noise_std > 0.0) return channel.noise_std;
  const auto sensor = asset.sensors.find(channel.name);
  const double expected = sensor == asset.sensors.end() ? 0.0 : sensor->second.noise_std;
  // A counter that stands still for most of the test shows no noise at all; it has some when it turns.
  return std::max(estimate_noise_floor(channel.values).standard_deviation, kLeastShareOfSensor * expected);
}

double time_constant_of(const AssetConfig& asset, const std::string& channel) {
  const auto sensor = asset.sensors.find(channel);
  return sensor == asset.sensors.end() ? 0.0 : sensor->second.time_constant_s;
}

}  // namespace sealwatch
