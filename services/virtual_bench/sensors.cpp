#include "services/virtual_bench/sensors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sealwatch/core/text.hpp"
#include "services/virtual_bench/random.hpp"

namespace sealwatch::bench {
namespace {

constexpr std::array<std::pair<std::string_view, Quantity>, 10> kQuantities = {{
    {"motor_voltage", Quantity::motor_voltage},
    {"motor_current", Quantity::motor_current},
    {"shaft_speed", Quantity::shaft_speed},
    {"pressure_a", Quantity::pressure_a},
    {"pressure_b", Quantity::pressure_b},
    {"pressure_differential", Quantity::pressure_differential},
    {"flow", Quantity::flow},
    {"position", Quantity::position},
    {"velocity", Quantity::velocity},
    {"rod_force", Quantity::rod_force},
}};

SensorSetting setting_of(const AssetConfig& asset, const ChannelDescription& channel) {
  if (const auto own = asset.sensors.find(channel.name); own != asset.sensors.end()) return own->second;
  return {.noise_std = channel.noise_std,
          .time_constant_s = channel.time_constant_s,
          .quantisation = 0.0,
          .range_min = channel.range_min,
          .range_max = channel.range_max};
}

}  // namespace

std::vector<std::string> default_channels() {
  return {"motor_voltage", "motor_current", "shaft_speed", "pressure_a", "pressure_b", "flow", "position", "velocity"};
}

Result<std::vector<Sensor>> find_sensors(const AssetConfig& asset, const PlantDescription& plant,
                                         const std::vector<std::string>& channels) {
  std::vector<Sensor> sensors;
  for (const std::string& name : channels) {
    const auto* const known =
        std::find_if(kQuantities.begin(), kQuantities.end(), [&](const auto& entry) { return entry.first == name; });
    const ChannelDescription* const channel = plant.find_channel(name);
    if (known == kQuantities.end() || channel == nullptr) {
      std::vector<std::string> names;
      names.reserve(kQuantities.size());
      for (const auto& entry : kQuantities) names.emplace_back(entry.first);
      return fail(Error{.file = {},
                        .place = "channel",
                        .value = name,
                        .rule = "is not a channel that the bench records",
                        .advice = suggest(name, names)});
    }
    sensors.push_back(
        {.channel = name, .unit = channel->unit, .quantity = known->second, .setting = setting_of(asset, *channel)});
  }
  return sensors;
}

Series measure(const Sensor& sensor, std::vector<double> values, std::uint64_t seed, std::span<const double> time_s) {
  NormalRandom normal(sub_seed(seed, sensor.channel));
  const double step = sensor.setting.quantisation;
  for (std::size_t k = 0; k < values.size(); ++k) {
    double& value = values[k];
    value = (1.0 + sensor.error.gain) * value + sensor.error.bias;
    if (!time_s.empty())
      value += sensor.error.drift * (1.0 - std::exp((time_s.front() - time_s[k]) / sensor.error.drift_time_s));
    value -= sensor.error.cut * std::max(value - sensor.error.end, 0.0);
    value = (1.0 + sensor.setting.gain_error) * value + sensor.setting.offset_error;
    value += sensor.setting.noise_std * normal.next();
    if (step > 0.0) value = step * std::round(value / step);
  }
  // Rounding to a step q adds an error that is uniform over q: variance q^2 / 12.
  const double noise_std = std::sqrt(sensor.setting.noise_std * sensor.setting.noise_std + step * step / 12.0);
  return {.name = sensor.channel, .unit = sensor.unit, .noise_std = noise_std, .values = std::move(values)};
}

}  // namespace sealwatch::bench
