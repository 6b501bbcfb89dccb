// What the equations of plant `eha` leave open: names, scales, inputs, outputs, start values (plant_simulation.hpp).
#pragma once

#include "sealwatch/model/eha.hpp"
#include "sealwatch/model/no_extra.hpp"
#include "services/common/model/plant_simulation.hpp"
#include "services/common/model/start_values.hpp"

namespace sealwatch {

struct EhaModel {
  using Equations = Eha;
  static constexpr std::array<std::string_view, Eha::kStates> kStateNames = {"z",   "i",   "omega", "p_1", "p_2",
                                                                             "p_A", "p_B", "v",     "x"};
  static constexpr std::array<std::string_view, 3> kSlowStates = {"p_A", "p_B", "x"};
  static constexpr std::array<bool, Eha::kStates> kQuasiSteady = {true,  true,  true, true, true,
                                                                  false, false, true, false};
  // Allowed local error of one step: small against what the nominal sensors resolve after averaging over a test. What is
  // in error in the motor's circuit is forgotten in milliseconds, and resolved by the current's sensor alone (20 mA).
  static constexpr std::array<double, Eha::kStates> kScale = {1e-3, 5e-4, 1e-3, 30.0, 30.0, 30.0, 30.0, 1e-7, 1e-9};
  static constexpr int kMaximumOrder = 5;
  static constexpr std::array<ModelInput, 1> kInputs = {{{"motor_voltage", false}}};
  static constexpr std::array<ModelOutput, 9> kOutputs = {{{"motor_current", Eha::kI},
                                                           {"shaft_speed", Eha::kOmega},
                                                           {"pressure_a", Eha::kPA},
                                                           {"pressure_b", Eha::kPB},
                                                           {"pressure_differential", -1},
                                                           {"flow", -1},
                                                           {"position", Eha::kX},
                                                           {"velocity", Eha::kV},
                                                           {"rod_force", -1}}};
  enum Output { kDifferential = 4, kFlow = 5, kRodForce = 8 };
  static constexpr std::array<std::size_t, 2> kOutputSites = {Eha::kDrop1, Eha::kCrack1};

  static Eha::Input input(const std::array<double, 1>& values, const std::array<double, 1>& slopes) {
    return {values[0], slopes[0]};
  }

  template <class S, class P, class Extra = NoExtra>
  static auto output(int which, const Eha::State<S>& y, const Eha::Input&, const EhaParameters<P>& p,
                     const Extra& extra = {}) {
    using R = decltype(y[0] * p.R_M + extra[Eha::kDrop1]);
    if (which == kDifferential) return R(y[Eha::kPA] - y[Eha::kPB]);
    if (which == kFlow)
      return R(Eha::valve_flow(y[Eha::kP1], y[Eha::kPA], y[Eha::kP2], p, extra[Eha::kDrop1], extra[Eha::kCrack1]));
    return R(p.phi * (1.0 + p.load_factor));
  }

  /// Pressures, position and what else was recorded from the first samples; the load that balances the mean pressures.
  static ModelValues start(const PlantDescription& plant, const AssetConfig& asset, const TimeSeries& recorded) {
    ModelValues values;
    values.parameters = parameter_values(plant, asset);
    const auto parameter = [&](std::string_view name) { return parameter_value(plant, values, name); };
    const double area_a = parameter("A_C"), area_b = area_a * parameter("area_ratio");
    const double p_0 = parameter("p_0"), load = parameter("phi");
    const auto pressures = [&](auto statistic) {
      // Without chamber pressures: the nominal load rests on chamber A, chamber B is at the reservoir's pressure.
      const double p_B = statistic("pressure_b").value_or(p_0);
      const double dp = statistic("pressure_differential").value_or((load + (area_b - area_a) * p_B) / area_a);
      return std::pair(statistic("pressure_a").value_or(p_B + dp), p_B);
    };
    const auto first = [&](std::string_view channel) { return first_value(recorded, channel); };
    const auto mean = [&](std::string_view channel) { return mean_value(recorded, channel); };
    const auto [p_A, p_B] = pressures(first);
    const auto [mean_A, mean_B] = pressures(mean);
    const double friction = parameter("f_C") * mean("velocity").value_or(0.0);
    values.load_factor = (area_a * mean_A - area_b * mean_B - friction) / load - 1.0;
    values.initial_state = {first("motor_voltage").value_or(0.0),
                            first("motor_current").value_or(0.0),
                            first("shaft_speed").value_or(0.0),
                            p_A,
                            std::min(p_0, p_B),
                            p_A,
                            p_B,
                            0.0,
                            first("position").value_or(0.5 * parameter("x_C"))};
    return values;
  }
};

}  // namespace sealwatch
