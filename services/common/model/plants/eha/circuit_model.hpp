// What the equations of plant `eha` (cylinder circuit) leave open: names, scales, inputs, outputs, start values
// (plant_simulation.hpp).
#pragma once

#include "sealwatch/model/eha_circuit.hpp"
#include "services/common/model/plant_simulation.hpp"
#include "services/common/model/start_values.hpp"

namespace sealwatch {

struct EhaCircuitModel {
  using Equations = EhaCircuit;
  static constexpr std::array<std::string_view, EhaCircuit::kStates> kStateNames = {"p_A", "v", "x"};
  static constexpr std::array<std::string_view, 2> kSlowStates = {"p_A", "x"};
  static constexpr std::array<bool, EhaCircuit::kStates> kQuasiSteady = {false, true, false};
  static constexpr std::array<double, EhaCircuit::kStates> kScale = {30.0, 1e-7, 1e-9};
  static constexpr int kMaximumOrder = 5;
  static constexpr std::array<ModelInput, 2> kInputs = {{{"flow", false}, {"pressure_b", false}}};
  static constexpr std::array<ModelOutput, 5> kOutputs = {{{"pressure_a", EhaCircuit::kPA},
                                                           {"pressure_differential", -1},
                                                           {"position", EhaCircuit::kX},
                                                           {"velocity", EhaCircuit::kV},
                                                           {"rod_force", -1}}};
  static constexpr int kDifferential = 1;

  static EhaCircuit::Input input(const std::array<double, 2>& values) { return {values[0], values[1]}; }

  template <class S, class P>
  static auto output(int which, const EhaCircuit::State<S>& y, const EhaCircuit::Input& input,
                     const EhaParameters<P>& p) {
    using R = decltype(y[0] * p.A_C);
    return which == kDifferential ? R(y[EhaCircuit::kPA] - input.pressure_b_Pa) : R(p.phi * (1.0 + p.load_factor));
  }

  static ModelValues start(const PlantDescription& plant, const AssetConfig& asset, const TimeSeries& recorded) {
    ModelValues values;
    values.parameters = parameter_values(plant, asset);
    const auto parameter = [&](std::string_view name) { return parameter_value(plant, values, name); };
    const double area_a = parameter("A_C"), area_b = area_a * parameter("area_ratio"), load = parameter("phi");
    const auto pressure_a = [&](auto statistic) {
      const double p_B = *statistic(recorded, "pressure_b");
      const double dp =
          statistic(recorded, "pressure_differential").value_or((load + (area_b - area_a) * p_B) / area_a);
      return statistic(recorded, "pressure_a").value_or(p_B + dp);
    };
    const double friction = parameter("f_C") * mean_value(recorded, "velocity").value_or(0.0);
    const double force = area_a * pressure_a(mean_value) - area_b * *mean_value(recorded, "pressure_b") - friction;
    values.load_factor = force / load - 1.0;
    values.initial_state = {pressure_a(first_value), 0.0,
                            first_value(recorded, "position").value_or(0.5 * parameter("x_C"))};
    return values;
  }
};

}  // namespace sealwatch
