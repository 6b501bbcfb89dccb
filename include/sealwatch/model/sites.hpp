// Sites: the places in a plant's balances at which laws of the catalogue (model/physics.hpp) add their contribution.
//
// A plant's derivatives() takes what is added at each site, `extra[k]`, as its last argument: NoExtra (model/no_extra.hpp)
// for the plant as it is. Every plant's description has its sites, hence this header knows nothing of laws.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "sealwatch/core/fields.hpp"

namespace sealwatch {

/// What a site takes, with its unit, and the signals that laws see there (unused ones are 0).
///   voltage_command  V          current i, command u, its rate du/dt
///   winding_voltage  V          current i, speed omega
///   shaft_torque     N m        speed omega, pressure difference p_1 - p_2, current i
///   pump_slip        m3/s       pressure difference p_1 - p_2, speed omega
///   line_drop        Pa         flow into the chamber q, pressure drop D
///   valve_crack      Pa         pressure drop D over the valve, flow q     (lowers the cracking pressure)
///   outflow          m3/s       pressure above the reservoir p - p_0
///   compliance       m3/Pa      absolute pressure
///   seal_leakage     m3/s       pressure difference p_A - p_B, speed v, position x
///   piston_force     N          speed v, position x, p_A, p_B
///   inverse_modulus  1/Pa       absolute pressure                          (added to 1/beta)
///   viscosity        1          dissipated power |z i|                     (relative change of viscosity)
///   tank_flow        V/s        level                                      (of the tank that the flow leaves)
///   own              plant's    the plant's (a balance of none of these kinds, for laws of the plant's own)
///   sensor_*         channel    the simulated channel
///   input_*          channel    the recorded input
///   clock_rate       1          none
SEALWATCH_ENUM(SiteKind, voltage_command, winding_voltage, shaft_torque, pump_slip, line_drop, valve_crack, outflow,
               compliance, seal_leakage, piston_force, inverse_modulus, viscosity, tank_flow, own, sensor_bias,
               sensor_gain, sensor_lag, sensor_drift, sensor_saturation, input_gain, input_bias, input_delay,
               input_clock_rate, clock_rate)

/// Laws of one measurement, which the simulation applies itself to what it simulated.
[[nodiscard]] constexpr bool is_sensor(SiteKind kind) {
  return kind >= SiteKind::sensor_bias && kind <= SiteKind::sensor_saturation;
}
/// Laws of the recorded input and of the recording's clock, which the simulation applies to the recording itself.
[[nodiscard]] constexpr bool is_of_recording(SiteKind kind) { return kind > SiteKind::sensor_saturation; }
/// Either: it takes no part in the physics.
[[nodiscard]] constexpr bool is_of_measurement(SiteKind kind) { return is_sensor(kind) || is_of_recording(kind); }

/// What a command's voltage feeds, where that is known: dead times of a bridge are asked at motors, the voltage below
/// which a pump delivers nothing at pumps. A site or law of `anything` goes with all.
SEALWATCH_ENUM(Feeds, anything, motor, pump)

inline constexpr std::size_t kSiteSignals = 4;

/// Of a site of kind own, whose words are the plant's.
struct SiteSignal {
  std::string_view name, unit;
};

/// One site of a plant. Its index in the plant's table is its place in `extra`.
struct Site {
  std::string_view element;  ///< of the plant's description
  SiteKind kind;
  Feeds feeds = Feeds::anything;  ///< of a command's voltage
  std::string_view unit = {};     ///< of a site of kind own
  std::array<SiteSignal, kSiteSignals> signals = {};
  std::array<bool, kSiteSignals> absent = {};  ///< signals of its kind that the plant does not give: 0
};

}  // namespace sealwatch
