// Sensors of the bench: which quantity a channel shows, and what the sensor makes of it.
//
//   tau dy/dt = quantity - y          low-pass, integrated with the actuator (tau = 0: y = quantity)
//   sample    = q round((y + e) / q)  e ~ N(0, noise_std^2), q the quantisation step (q = 0: none)
//
// An asset's `physics` may give a sensor errors besides (SensorError); its lag is integrated, the others come before e,
// and so does what the asset's `sensors` say that it is off by (gain_error, offset_error).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/time_series.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "services/virtual_bench/bench_physics.hpp"

namespace sealwatch::bench {

enum class Quantity {
  motor_voltage,
  motor_current,
  shaft_speed,
  pressure_a,
  pressure_b,
  pressure_differential,
  flow,
  position,
  velocity,
  rod_force
};

struct Sensor {
  std::string channel;
  std::string unit;
  Quantity quantity = Quantity::position;
  SensorSetting setting = {};
  SensorError error = {};
};

/// Channels that a bench records where nothing else is asked: all that the plant has but the redundant ones.
[[nodiscard]] std::vector<std::string> default_channels();

/// The sensors of `channels` with the asset's settings, the plant's where the asset has none.
[[nodiscard]] Result<std::vector<Sensor>> find_sensors(const AssetConfig& asset, const PlantDescription& plant,
                                                       const std::vector<std::string>& channels);

/// Adds the sensor's errors, noise and quantisation to low-passed values. The noise depends on the seed and the
/// channel's name alone, so a channel that is added or left out does not change the others. Without times no zero drifts.
[[nodiscard]] Series measure(const Sensor& sensor, std::vector<double> values, std::uint64_t seed,
                             std::span<const double> time_s = {});

}  // namespace sealwatch::bench
