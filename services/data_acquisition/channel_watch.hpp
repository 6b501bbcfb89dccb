// What is noticed on one channel while its samples come in: frozen, out of range, not a number.
//
// A value that stays exactly the same is suspicious only where it should not:
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
#include "services/data_acquisition/options.hpp"

namespace sealwatch {

/// How far the actuator has come by each kinematic channel; NaN where that channel is not recorded.
enum class Witness { position, velocity, pump_angle, shaft_speed };
inline constexpr std::size_t kWitnesses = 4;
using Travel = std::array<double, kWitnesses>;  ///< m, m (integral of velocity), rad, rad (integral of speed)

class ChannelWatch {
 public:
  ChannelWatch(const ChannelDescription& channel, const SensorSetting& sensor, double stroke_m);
  void add(double time_s, double value, const Travel& travel, const DataAcquisitionOptions& options);
  /// A block is missing: what was constant before need not have been in between.
  void interrupt() { run_.count = 0; }
  [[nodiscard]] ChannelStatus status(const DataAcquisitionOptions& options) const;

 private:
  struct Run {
    double value = 0.0;
    double begin_s = 0.0;
    std::uint64_t count = 0;
    Travel least{};
    Travel most{};
  };
  struct Frozen {
    double value = 0.0;
    double begin_s = 0.0;
    double end_s = 0.0;
    std::uint64_t count = 0;
  };
  void extend_run(double time_s, double value, const Travel& travel);
  [[nodiscard]] bool frozen(double time_s, const DataAcquisitionOptions& options) const;
  [[nodiscard]] bool moved() const;
  void check_range(double time_s, double value);
  [[nodiscard]] std::string frozen_reason() const;
  [[nodiscard]] std::string range_reason() const;

  std::string name_;
  std::string unit_;
  bool judged_ = true;       ///< whether constancy says anything
  bool noise_rule_ = false;  ///< whether constancy alone is enough
  std::array<bool, kWitnesses> witness_{};
  double stroke_m_ = 0.0;
  double range_min_ = 0.0;
  double range_max_ = 0.0;
  std::uint64_t count_ = 0;
  std::uint64_t not_a_number_ = 0;
  std::uint64_t out_of_range_ = 0;
  double worst_ = 0.0;
  double worst_s_ = 0.0;
  Run run_;
  Frozen frozen_;  ///< the longest
};

}  // namespace sealwatch
