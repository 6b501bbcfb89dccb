// What the equations of plant `cascaded_tanks` leave open: names, scales, inputs, outputs, start values
// (plant_simulation.hpp).
#pragma once

#include "sealwatch/model/cascaded_tanks.hpp"
#include "services/common/model/plant_simulation.hpp"
#include "services/common/model/start_values.hpp"

namespace sealwatch {

struct CascadedTanksModel {
  using Equations = CascadedTanks;
  static constexpr std::array<std::string_view, CascadedTanks::kStates> kStateNames = {"level_upper", "level_lower"};
  static constexpr std::array<std::string_view, 2> kSlowStates = {"level_upper", "level_lower"};
  static constexpr std::array<bool, CascadedTanks::kStates> kQuasiSteady = {false, false};
  static constexpr std::array<double, CascadedTanks::kStates> kScale = {1e-5, 1e-5};
  static constexpr int kMaximumOrder = 5;
  static constexpr std::array<ModelInput, 1> kInputs = {{{"pump_voltage", true}}};
  static constexpr std::array<ModelOutput, 1> kOutputs = {{{"level_voltage", CascadedTanks::kLower}}};

  static CascadedTanks::Input input(const std::array<double, 1>& values) { return {values[0]}; }

  /// The only output is a state: never called.
  template <class S, class P>
  static auto output(int, const CascadedTanks::State<S>& y, const CascadedTanks::Input&,
                     const CascadedTanksParameters<P>& p) {
    return y[CascadedTanks::kLower] + 0.0 * p.k1;
  }

  /// The lower level from the first samples; the upper one as if the lower one stood still: a k1 sqrt(x_1) = k3
  /// sqrt(x_2).
  static ModelValues start(const PlantDescription& plant, const AssetConfig& asset, const TimeSeries& recorded) {
    ModelValues values;
    values.parameters = parameter_values(plant, asset);
    const auto parameter = [&](std::string_view name) { return parameter_value(plant, values, name); };
    const double lower = *first_value(recorded, "level_voltage");
    const double ratio = parameter("k3") / (parameter("area_ratio") * parameter("k1"));
    values.initial_state = {ratio * ratio * lower, lower};
    return values;
  }
};

}  // namespace sealwatch
