// The features of one partial stroke test: one table of names, units and meanings for code, messages, screens and
// docs/reference/features.md.
//
//   p_L = p_A - r p_B            load pressure [Pa]; r = A_B / A_A, 1 for a piston of equal areas; where only the
//                                differential pressure is recorded, p_L is that
//   q_leak = q - A_A v - (V_A/beta) dp_A/dt     flow that neither moves the piston nor compresses the oil [m3/s],
//                                by the mass balance of chamber A (docs/model.md); positive from A to B
//
// Signs: x, v, q and p_L as in docs/model.md; features that say "drop", "decay" or "resistance" are positive as a rule.
// A feature that this recording cannot give is absent. Standard errors hold for the noise in the data, not for errors
// of the asset's parameters.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sealwatch::signal {

struct Feature {
  std::string name;
  std::string unit;
  double value = 0.0;
  double std_error = 0.0;
};

struct FeatureDescription {
  std::string_view name;
  std::string_view unit;
  std::string_view meaning;
};

inline constexpr FeatureDescription kFeatures[] = {
    {"travel", "m", "largest distance of the piston from where it started"},
    {"return_error", "m", "position in the last hold minus position at rest; absent when the test did not return"},
    {"stroke_time_out", "s", "time from 5 % to 95 % of the first stroke out"},
    {"stroke_time_back", "s", "time from 5 % to 95 % of the first stroke back"},
    {"speed_out", "m/s", "mean speed over the middle of the strokes out, positive"},
    {"speed_back", "m/s", "mean speed over the middle of the strokes back, positive"},
    {"breakaway_time", "s", "from the first sign of effort to half the stroke's speed"},
    {"breakaway_pressure", "Pa",
     "largest change of p_L from rest, in the direction of the motion, until the piston runs"},
    {"rest_pressure", "Pa", "mean of p_L at rest"},
    {"running_pressure_out", "Pa", "mean of p_L over the middle of the strokes out"},
    {"running_pressure_back", "Pa", "mean of p_L over the middle of the strokes back"},
    {"friction_pressure", "Pa",
     "half of the difference of the running pressures: friction seen as pressure, load taken out"},
    {"hold_pressure", "Pa", "mean of p_L in the holds after a stroke out"},
    {"hold_decay", "Pa/s", "rate at which |p_L| falls in the holds after a stroke out"},
    {"leakage_flow", "m3/s", "q_leak at standstill (rest and all holds), the holds weighted by their precision"},
    {"leakage_flow_rest", "m3/s", "q_leak at rest"},
    {"leakage_flow_hold", "m3/s", "q_leak in the holds"},
    {"leakage_flow_out", "m3/s", "q_leak over the middle of the strokes out"},
    {"leakage_flow_back", "m3/s", "q_leak over the middle of the strokes back"},
    {"leakage_resistance", "Pa s/m3", "(p_A - p_B) / q_leak at standstill"},
    {"peak_current", "A", "largest |motor_current| after smoothing"},
    {"running_current_out", "A", "mean motor_current over the middle of the strokes out"},
    {"running_current_back", "A", "mean motor_current over the middle of the strokes back"},
    {"peak_voltage", "V", "largest |motor_voltage|"},
    {"running_voltage_out", "V", "mean motor_voltage over the middle of the strokes out"},
    {"running_voltage_back", "V", "mean motor_voltage over the middle of the strokes back"},
    {"running_shaft_speed_out", "rad/s", "mean shaft_speed over the middle of the strokes out"},
    {"running_shaft_speed_back", "rad/s", "mean shaft_speed over the middle of the strokes back"},
    {"volumetric_efficiency_out", "1",
     "A v / (alpha_P omega) in the strokes out: share of the pump's flow that moves the piston"},
    {"volumetric_efficiency_back", "1", "the same in the strokes back; above 1 where the load drives the pump"},
    {"drive_saturation", "1",
     "share of the test in which the drive (voltage or duty) stood still at its largest magnitude"},
    {"fluid_temperature", "K", "mean fluid temperature"},
};

/// The table's row of that name; nullptr when there is none.
[[nodiscard]] const FeatureDescription* find_feature(std::string_view name);

class TestRecord;

/// All features that the test gives, in the table's order.
[[nodiscard]] std::vector<Feature> compute_features(const TestRecord& test);

}  // namespace sealwatch::signal
