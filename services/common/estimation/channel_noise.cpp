#include "services/common/estimation/channel_noise.hpp"

#include <algorithm>
#include <cmath>

#include "sealwatch/signal/noise_floor.hpp"

namespace sealwatch {
namespace {

/// Of a channel's spread, where nobody says what its noise is: a recording that was simulated shows none, and what the
/// integration errs by is no misfit.
constexpr double kLeastShare = 1e-5;

double spread_of(std::span<const double> values) {
  double sum = 0.0, squares = 0.0;
  const auto count = static_cast<double>(std::max<std::size_t>(1, values.size()));
  for (const double value : values) sum += value;
  for (const double value : values) squares += (value - sum / count) * (value - sum / count);
  return std::sqrt(squares / count);
}

}  // namespace

double noise_std_of(const AssetConfig& asset, const Series& channel, std::span<const double> time_s) {
  const auto sensor = asset.sensors.find(channel.name);
  const double usual = sensor == asset.sensors.end() ? 0.0 : sensor->second.noise_std;
  const double believed = signal::believed_noise_std(channel, usual, time_s);
  return channel.noise_std > 0.0 || usual > 0.0 ? believed
                                                : std::max(believed, kLeastShare * spread_of(channel.values));
}

double noise_std_of(const AssetConfig& asset, const Series& channel) { return noise_std_of(asset, channel, {}); }

double time_constant_of(const AssetConfig& asset, const std::string& channel) {
  const auto sensor = asset.sensors.find(channel);
  return sensor == asset.sensors.end() ? 0.0 : sensor->second.time_constant_s;
}

}  // namespace sealwatch
