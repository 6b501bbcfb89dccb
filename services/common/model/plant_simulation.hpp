// PlantSimulation for one plant whose equations are known when sealwatch is built.
//
// Model says what the equations (sealwatch/model/<plant>.hpp) leave open:
//   Equations; kStateNames, kSlowStates, kQuasiSteady, kMaximumOrder, kScale (allowed local error of a step at relative
//   tolerance 1e-6); kInputs {name, hold}, input(values) -> Equations::Input; kOutputs {channel, state it equals or
//   -1}; output(k, state, input, parameters[, what laws add]) of an output that is no state; kOutputSites where it
//   sees what laws add; start(asset values, recorded) -> ModelValues.
#pragma once

#include <string>
#include <utility>

#include "services/common/model/plant_outputs.hpp"
#include "services/common/model/recording_run.hpp"

namespace sealwatch {

template <class Model>
class PlantSimulationOf final : public RecordedSimulation {
 public:
  PlantSimulationOf(const PlantDescription& plant, const AssetConfig& asset, const TimeSeries& recorded,
                    PhysicsTerms terms)
      : RecordedSimulation(plant, std::move(terms), input_names(), {recorded.time_s, input_channels(recorded)}) {
    std::vector<OutputName> outputs;
    for (const auto& [channel, state] : Model::kOutputs) outputs.push_back({std::string(channel), state});
    select_channels(outputs, asset, recorded);
    set_states({Model::kStateNames.begin(), Model::kStateNames.end()},
               {Model::kSlowStates.begin(), Model::kSlowStates.end()}, Model::start(plant, asset, recorded));
  }

  [[nodiscard]] std::span<const Site> sites() const override { return sites_of_plant(); }

  /// Empty where the equations have none.
  [[nodiscard]] static std::span<const Site> sites_of_plant() {
    if constexpr (requires { Model::Equations::kSites; }) return Model::Equations::kSites;
    return {};
  }

 private:
  [[nodiscard]] bool differentiates_by_recording() const override { return true; }
  [[nodiscard]] Result<SimulatedOutputs> run_driven_by(const RecordedInput& input, const ModelValues& values,
                                                       std::span<const FreeQuantity> free,
                                                       const SimulationOptions& options,
                                                       InjectedColumns* injected) const override {
    if (!terms().active.empty() || injected != nullptr) return run_with_physics(input, values, free, options, injected);
    if (free.size() <= 4) return run_with<4, false>(input, values, free, options, nullptr);
    if (free.size() <= 8) return run_with<8, false>(input, values, free, options, nullptr);
    return run_with<12, false>(input, values, free, options, nullptr);
  }

  static std::vector<std::string> input_names() {
    std::vector<std::string> names;
    for (const auto& input : Model::kInputs) names.emplace_back(input.name);
    return names;
  }
  static std::vector<InputChannel> input_channels(const TimeSeries& recorded) {
    std::vector<InputChannel> channels;
    for (const auto& input : Model::kInputs)
      channels.push_back({recorded.find(input.name)->values, input.hold || recorded.input_hold});
    return channels;
  }

  template <int Width, bool WithPhysics>
  [[nodiscard]] Result<SimulatedOutputs> run_with(const RecordedInput& input, const ModelValues& values,
                                                  std::span<const FreeQuantity> free, const SimulationOptions& options,
                                                  InjectedColumns* injected) const {
    RecordedPlantSystem<Model, Width, WithPhysics> system(input, terms(), values, free, injected);
    return run_over_recording(*this, input, system, values, free, options, injected).outputs;
  }
  /// With the laws in force and columns injected: in a translation unit of its own (plant_physics.hpp).
  [[nodiscard]] Result<SimulatedOutputs> run_with_physics(const RecordedInput& input, const ModelValues& values,
                                                          std::span<const FreeQuantity> free,
                                                          const SimulationOptions& options,
                                                          InjectedColumns* injected) const;
};

}  // namespace sealwatch
