// A plant of one's own, complete: a valve positioner with a return spring. Documented in
// docs/reference/plant-in-cpp.md.
//
//   drive   F = k_F u                                u  command to the drive [V]
//   piston  M dv/dt = F - F_v v - k_s x              v  velocity of the stem [m/s]
//           dx/dt = v                                x  position of the stem [m], 0 where the spring is at rest
//
// M: moved mass [kg]; F_v: viscous friction [N s/m]; k_s: stiffness of the spring [N/m]; k_F: force per voltage [N/V].
// Force balance of a mass on a spring. What the model lacks may act on the drive's voltage or on the piston.
#pragma once

#include <array>

#include "sealwatch/core/fields.hpp"
#include "sealwatch/model/no_extra.hpp"
#include "sealwatch/model/sites.hpp"
#include "services/common/model/own_plant.hpp"
#include "services/common/model/plant_tables.hpp"

namespace sealwatch::example {

// 1. The equations: parameters, state, where laws may act, time derivatives. Scalars are templates for the derivatives.
template <class P>
struct SpringReturnParameters {
  P M, F_v, k_s, k_F;
  P load_factor;  // every plant's parameters end with it; this plant has no load that it could scale
  SEALWATCH_FIELDS(SpringReturnParameters, M, F_v, k_s, k_F, load_factor)
};

struct SpringReturn {
  static constexpr int kStates = 2;
  template <class P>
  using Parameters = SpringReturnParameters<P>;
  template <class S>
  using State = std::array<S, kStates>;
  enum Index { kX, kV };
  struct Input {
    double voltage_V = 0.0;
    double voltage_rate_V_s = 0.0;
  };

  static constexpr std::array kSites = {Site{"driver", SiteKind::voltage_command, Feeds::motor},
                                        Site{"piston", SiteKind::piston_force}};
  enum SiteIndex { kDriverVoltage, kPistonForce };

  // What laws see at a site, in the order that model/sites.hpp gives for its kind.
  template <class R, class S, class P, class Extra>
  static std::array<R, kSiteSignals> signals(std::size_t site, const State<S>& y, const Input& input,
                                             const SpringReturnParameters<P>&, const Extra&) {
    if (site == kDriverVoltage) return {R(0.0), R(input.voltage_V), R(input.voltage_rate_V_s), R(0.0)};
    return {R(y[kV]), R(y[kX]), R(0.0), R(0.0)};
  }

  // extra[k]: what the laws at site k add; a loss is positive.
  template <class S, class P, class Extra = NoExtra>
  static auto derivatives(const State<S>& y, const Input& input, const SpringReturnParameters<P>& p,
                          const Extra& extra = {}) {
    const auto& [x, v] = y;
    const auto force = p.k_F * (input.voltage_V - extra[kDriverVoltage]);
    const auto acceleration = (force - p.F_v * v - p.k_s * x - extra[kPistonForce]) / p.M;
    using R = decltype(v + acceleration);
    return State<R>{R(v), R(acceleration)};
  }
};

// 2. What the equations leave open: names, error scales, inputs, outputs, start values.
struct SpringReturnModel {
  using Equations = SpringReturn;
  static constexpr std::array<std::string_view, 2> kStateNames = {"x", "v"};
  static constexpr std::array<std::string_view, 1> kSlowStates = {"x"};  // each recording's own, estimated
  static constexpr std::array<bool, 2> kQuasiSteady = {false, false};
  static constexpr std::array<double, 2> kScale = {1e-9, 1e-8};  // local error of a step at relative tolerance 1e-6
  static constexpr int kMaximumOrder = 5;
  static constexpr std::array<ModelInput, 1> kInputs = {{{"drive_voltage", false}}};
  static constexpr std::array<ModelOutput, 1> kOutputs = {{{"position", SpringReturn::kX}}};

  static SpringReturn::Input input(const std::array<double, 1>& values, const std::array<double, 1>& slopes) {
    return {values[0], slopes[0]};
  }
  template <class S, class P>
  static auto output(int, const SpringReturn::State<S>& y, const SpringReturn::Input&, const P& p) {
    return y[SpringReturn::kX] + 0.0 * p.M;  // the only output is a state: never called
  }
  static ModelValues start(const PlantDescription& plant, const AssetConfig& asset, const TimeSeries& recorded) {
    return {.parameters = parameter_values(plant, asset),
            .load_factor = 0.0,
            .initial_state = {*first_value(recorded, "position"), 0.0}};
  }
};

// 3. The table: channels, parameters with units and bounds, elements, sizes. It serves files, messages and reports.
inline PlantDescription describe_spring_return() {
  PlantDescription plant{
      .name = "spring_return",
      .meaning = "valve positioner with a return spring",
      .channels = {{.name = "drive_voltage", .unit = "V", .meaning = "command u to the drive", .input = true},
                   {.name = "position", .unit = "m", .meaning = "stem position x", .noise_std = 1e-5}},
      .parameters = {scale_parameter("M", "kg", 20.0, "moved mass", true),
                     scale_parameter("F_v", "N s/m", 2e3, "viscous friction", true),
                     scale_parameter("k_s", "N/m", 1e4, "stiffness of the return spring", true),
                     scale_parameter("k_F", "N/V", 100.0, "force of the drive per voltage")},
      .states = {{"x", "m", "stem position"}, {"v", "m/s", "stem velocity"}},
      .elements = {{"driver", "force of the drive from its command"}, {"piston", "force on the stem"}},
      .sites = {SpringReturn::kSites.begin(), SpringReturn::kSites.end()},
      // Against `eha`: 1 kN for 60 kN, tens of mm/s. add_plant() names a unit that is forgotten.
      .law_sizes = {{"N", 0.02},
                    {"m", 1.0},
                    {"m/s", 10.0},
                    {"N/m", 0.02},
                    {"N/m2", 0.02},
                    {"N s/m", 0.01},
                    {"N s2/m2", 1e-3},
                    {"m2", 0.02},
                    {"V", 1.0},
                    {"A", 1.0},
                    {"s", 1.0}}};
  add_sensor_elements(plant);
  return plant;
}

}  // namespace sealwatch::example
