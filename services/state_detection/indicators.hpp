// Condition indicators of one test: what state detection judges. Some are the test's features as they are, the others
// are steady-state balances solved for one coefficient each, so that the load, which differs by +-20 % from test to
// test, drops out of all of them but the load itself.
//
//   + extending, - retracting, h holding; dp = p_A - p_B; v from the position's change; G = 1 / leakage_resistance
//   leakage_resistance, friction_pressure, breakaway_pressure      features (include/sealwatch/signal/features.hpp)
//   load_pressure       (running_pressure_out + running_pressure_back) / 2            [Pa]
//   load_free_current   peak_current - alpha_P load_pressure / T_M                    [A]
//   hold_decay_rate     hold_decay / |hold_pressure|                                  [1/s]
//   pump_slip           (alpha_P omega_h - q_h) / dp_h                                [m3/(s Pa)]   port_1
//   shaft_drag          (T_M i_+ - alpha_P dp_+) / omega_+                            [N m s/rad]   shaft
//   back_emf            (u_+ - R_M i_+) / omega_+                                     [V s/rad]     winding
//   flow_gain           (q_+ - q_- - G (dp_+ - dp_-)) / (A (v_+ - v_-))               flow sensor against position
//   delivery_ratio      (q_+ - q_h) / (alpha_P (omega_+ - omega_h))                   flow sensor against shaft speed
//   velocity_gain       (velocity_+ - velocity_-) / (v_+ - v_-)                       velocity sensor against position
//   closing_time        x_C / |v_-|, v_- the velocity's mean where the position is not OK   [s]
//                       extrapolated to the full stroke
//   condition           theta by the value of what wears with which the simulation comes nearest to the recording [1],
//                       of assets whose condition does not go by their seal's leakage (residual.hpp)
//   fluid_temperature_deviation   fluid_temperature - 277.15 K                        [K]           the recording
//   drive_saturation, missing_share   features                                        [1]           the recording
//
// An indicator whose features, channels, phases or parameters are not there is absent. Drag and emf use the motion
// against the load alone: with the load, the pilot-operated valves and not the load set the port pressures.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/message/data_manipulation.hpp"

namespace sealwatch {

[[nodiscard]] std::vector<Quantity> condition_indicators(const AssetConfig& asset, const TestFeatures& features,
                                                         const TestWindow& window);

/// Value of a feature by name; nothing when the test did not give it.
[[nodiscard]] std::optional<double> feature_of(const TestFeatures& features, std::string_view name);

}  // namespace sealwatch
