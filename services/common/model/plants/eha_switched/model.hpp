// What the equations of plant `eha_switched` leave open: names, scales, inputs, outputs, start values
// (plant_simulation.hpp).
#pragma once

#include "sealwatch/model/eha_switched.hpp"
#include "services/common/model/plant_simulation.hpp"
#include "services/common/model/start_values.hpp"

namespace sealwatch {

struct EhaSwitchedModel {
  using Equations = EhaSwitched;
  static constexpr std::array<std::string_view, EhaSwitched::kStates> kStateNames = {
      "i", "omega", "theta", "p_P", "p_A", "p_B", "p_T", "v", "x"};
  static constexpr std::array<std::string_view, 3> kSlowStates = {"p_A", "p_B", "p_T"};
  // The bench waits at rest with its motor off: only the motor and the supply line find their own state.
  static constexpr std::array<bool, EhaSwitched::kStates> kQuasiSteady = {true,  true,  false, true, false,
                                                                          false, false, false, false};
  static constexpr std::array<double, EhaSwitched::kStates> kScale = {1e-3,  1e-2,  1e-4, 500.0, 500.0,
                                                                      500.0, 500.0, 1e-5, 1e-7};
  // Trapped oil and the light piston oscillate almost undamped; higher orders are not stable there.
  static constexpr int kMaximumOrder = 2;
  static constexpr std::array<ModelInput, 2> kInputs = {{{"motor_duty", false}, {"valve_state", true}}};
  static constexpr std::array<ModelOutput, 5> kOutputs = {{{"position", EhaSwitched::kX},
                                                           {"pressure_a", EhaSwitched::kPA},
                                                           {"pressure_b", EhaSwitched::kPB},
                                                           {"shaft_speed", -1},
                                                           {"pump_angle", EhaSwitched::kTheta}}};

  static EhaSwitched::Input input(const std::array<double, 2>& values) { return {values[0], values[1]}; }

  /// shaft_speed carries the sign of the valves' direction.
  template <class S, class P>
  static auto output(int, const EhaSwitched::State<S>& y, const EhaSwitched::Input& input,
                     const EhaSwitchedParameters<P>&) {
    return input.valve_state * y[EhaSwitched::kOmega];
  }

  /// Pressures and position from the first samples, that of the accumulator from the chamber that the valves join to it
  /// (at rest from the lower one); the load from the mean balance of forces while the piston extends.
  static ModelValues start(const PlantDescription& plant, const AssetConfig& asset, const TimeSeries& recorded) {
    ModelValues values;
    values.parameters = parameter_values(plant, asset);
    const auto parameter = [&](std::string_view name) { return parameter_value(plant, values, name); };
    const auto first = [&](std::string_view channel) { return first_value(recorded, channel); };
    const double preloaded = 1.25 * parameter("p_preload");
    const double p_A = first("pressure_a").value_or(preloaded), p_B = first("pressure_b").value_or(preloaded);
    const double valves = first("valve_state").value_or(0.0);
    const double p_T = valves > 0.5 ? p_B : valves < -0.5 ? p_A : std::min(p_A, p_B);
    values.load_factor =
        mean_load(recorded, parameter("A_A"), parameter("A_B")).value_or(parameter("phi")) / parameter("phi") - 1.0;
    values.initial_state = {0.0, 0.0, first("pump_angle").value_or(0.0), p_T, p_A, p_B,
                            p_T, 0.0, first("position").value_or(0.0)};
    return values;
  }

 private:
  static std::optional<double> mean_load(const TimeSeries& recorded, double A_A, double A_B) {
    const Series *p_A = recorded.find("pressure_a"), *p_B = recorded.find("pressure_b"),
                 *speed = recorded.find("shaft_speed");
    if (p_A == nullptr || p_B == nullptr || speed == nullptr) return std::nullopt;
    constexpr double kMoving_rad_s = 20.0;
    double sum = 0.0, count = 0.0;
    for (std::size_t row = 0; row < speed->values.size(); ++row)
      if (speed->values[row] > kMoving_rad_s) sum += A_A * p_A->values[row] - A_B * p_B->values[row], count += 1.0;
    return count > 0.0 ? std::optional(sum / count) : std::nullopt;
  }
};

}  // namespace sealwatch
