// What the equations of plant `emps` leave open: names, scales, inputs, outputs, start values (plant_simulation.hpp).
#pragma once

#include "sealwatch/model/emps.hpp"
#include "services/common/model/plant_simulation.hpp"
#include "services/common/model/start_values.hpp"

namespace sealwatch {

struct EmpsModel {
  using Equations = Emps;
  static constexpr std::array<std::string_view, Emps::kStates> kStateNames = {"x", "v"};
  static constexpr std::array<std::string_view, 2> kSlowStates = {"x", "v"};
  static constexpr std::array<bool, Emps::kStates> kQuasiSteady = {false, false};
  static constexpr std::array<double, Emps::kStates> kScale = {1e-11, 1e-9};
  static constexpr int kMaximumOrder = 5;
  static constexpr std::array<ModelInput, 1> kInputs = {{{"motor_voltage", false}}};
  static constexpr std::array<ModelOutput, 1> kOutputs = {{{"position", Emps::kX}}};

  static Emps::Input input(const std::array<double, 1>& values, const std::array<double, 1>& slopes) {
    return {values[0], slopes[0]};
  }

  /// The only output is a state: never called.
  template <class S, class P>
  static auto output(int, const Emps::State<S>& y, const Emps::Input&, const EmpsParameters<P>& p) {
    return y[Emps::kX] + 0.0 * p.M;
  }

  /// Position and velocity from the first samples.
  static ModelValues start(const PlantDescription& plant, const AssetConfig& asset, const TimeSeries& recorded) {
    constexpr std::size_t kSamples = 10;
    const std::vector<double>& position = recorded.find("position")->values;
    const std::size_t last = std::min(kSamples, position.size() - 1);
    const double velocity = (position[last] - position[0]) / (recorded.time_s[last] - recorded.time_s[0]);
    return {.parameters = parameter_values(plant, asset), .load_factor = 0.0, .initial_state = {position[0], velocity}};
  }
};

}  // namespace sealwatch
