// What the equations of plant `eha` (hydraulic part, driven by the flow) leave open: names, scales, inputs, outputs, start
// values (plant_simulation.hpp).
#pragma once

#include "sealwatch/model/eha_flow_driven.hpp"
#include "services/common/model/plants/eha/model.hpp"

namespace sealwatch {

struct EhaFlowDrivenModel {
  using Equations = EhaFlowDriven;
  static constexpr std::array<std::string_view, EhaFlowDriven::kStates> kStateNames = {"p_1", "p_2", "p_A",
                                                                                       "p_B", "v",   "x"};
  static constexpr std::array<std::string_view, 3> kSlowStates = EhaModel::kSlowStates;
  static constexpr std::array<bool, EhaFlowDriven::kStates> kQuasiSteady = {true, true, false, false, true, false};
  static constexpr std::array<double, EhaFlowDriven::kStates> kScale = {300.0, 300.0, 100.0, 100.0, 3e-6, 3e-9};
  static constexpr int kMaximumOrder = 5;
  static constexpr std::array<ModelInput, 1> kInputs = {{{"flow", false}}};
  static constexpr std::array<ModelOutput, 5> kOutputs = {{{"pressure_a", EhaFlowDriven::kPA},
                                                           {"pressure_differential", -1},
                                                           {"position", EhaFlowDriven::kX},
                                                           {"velocity", EhaFlowDriven::kV},
                                                           {"rod_force", -1}}};
  static constexpr int kDifferential = 1;

  static EhaFlowDriven::Input input(const std::array<double, 1>& values) { return {values[0]}; }

  template <class S, class P>
  static auto output(int which, const EhaFlowDriven::State<S>& y, const EhaFlowDriven::Input&,
                     const EhaParameters<P>& p) {
    using R = decltype(y[0] * p.A_C);
    return which == kDifferential ? R(y[EhaFlowDriven::kPA] - y[EhaFlowDriven::kPB]) : R(p.phi * (1.0 + p.load_factor));
  }

  static ModelValues start(const PlantDescription& plant, const AssetConfig& asset, const TimeSeries& recorded) {
    ModelValues values = EhaModel::start(plant, asset, recorded);
    values.initial_state.erase(values.initial_state.begin(), values.initial_state.begin() + Eha::kP1);
    return values;
  }
};

}  // namespace sealwatch
