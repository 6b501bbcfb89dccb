// What is noticed on one channel while its samples come in: frozen, out of range, not a number.
//
// A value that stays exactly the same is suspicious only where it should not (signal/stuck.hpp):
//   input      commands and references (table's `input`): may be constant as long as they like, never judged
//   slow       temperatures: constant for minutes is normal, never judged
//   kinematic  m, m/s, rad, rad/s: constant while the piston rests; frozen when constant while another kinematic
//              channel shows that the actuator moved (2 % of its stroke, or one revolution)
//   process    pressures, flow, current, force: their noise never repeats for long, so constant alone is frozen; where
//              the noise is not known or drowns in the sensor's steps, or the value is exactly zero (a meter's low-flow
//              cut-off), they are judged like kinematic ones
// Position is believed frozen only against velocity: a shaft that turns while the piston stands may also mean a
// piston that is stuck. Shaft speed and pump angle witness against each other, and position against both.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/message/common.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "sealwatch/signal/stuck.hpp"
#include "services/data_acquisition/options.hpp"

namespace sealwatch {

/// How far the actuator has come by each kinematic channel; NaN where that channel is not recorded.
enum class Witness { position, velocity, pump_angle, shaft_speed };
inline constexpr std::size_t kWitnesses = 4;
using Travel = std::array<double, kWitnesses>;  ///< m, m (integral of velocity), rad, rad (integral of speed)

class ChannelWatch {
 public:
  ChannelWatch(const ChannelDescription& channel, const SensorSetting& sensor, double stroke_m,
               const DataAcquisitionOptions& options);
  void add(double time_s, double value, const Travel& travel);
  /// A block is missing: what was constant before need not have been in between.
  void interrupt() { stuck_.interrupt(); }
  [[nodiscard]] ChannelStatus status(const DataAcquisitionOptions& options) const;

 private:
  void check_range(double time_s, double value);
  [[nodiscard]] std::string range_reason() const;

  std::string name_;
  std::string unit_;
  bool judged_ = true;  ///< whether constancy says anything
  double range_min_ = 0.0;
  double range_max_ = 0.0;
  std::uint64_t count_ = 0;
  std::uint64_t not_a_number_ = 0;
  std::uint64_t out_of_range_ = 0;
  double worst_ = 0.0;
  double worst_s_ = 0.0;
  signal::StuckWatch stuck_;
};

}  // namespace sealwatch
