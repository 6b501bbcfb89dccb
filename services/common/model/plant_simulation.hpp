// PlantSimulation for one plant: integration by segments of smooth input, sampling, sensors.
//
// Model says what the equations (sealwatch/model/<plant>.hpp) leave open:
//   Equations; kStateNames, kSlowStates, kQuasiSteady, kMaximumOrder, kScale (allowed local error of a step at relative
//   tolerance 1e-6); kInputs {name, hold}, input(values) -> Equations::Input; kOutputs {channel, state it equals or
//   -1}; output(k, state, input, parameters) of an output that is no state; start(asset values, recorded) ->
//   ModelValues.
#pragma once

#include <algorithm>
#include <string>
#include <utility>

#include "sealwatch/ode/bdf.hpp"
#include "services/common/model/plant_system.hpp"
#include "services/common/model/quasi_steady.hpp"
#include "services/common/model/sensor_filter.hpp"
#include "services/common/model/sensor_laws.hpp"

namespace sealwatch {

/// One simulated and recorded channel.
struct SimulatedChannel {
  int output = 0;  ///< index in Model::kOutputs
  double time_constant_s = 0.0;
};

template <class Model>
class PlantSimulationOf final : public PlantSimulation {
 public:
  static constexpr int kStates = Model::Equations::kStates;

  PlantSimulationOf(const PlantDescription& plant, const AssetConfig& asset, const TimeSeries& recorded,
                    PhysicsTerms terms)
      : plant_(plant),
        state_names_(Model::kStateNames.begin(), Model::kStateNames.end()),
        slow_state_names_(Model::kSlowStates.begin(), Model::kSlowStates.end()),
        input_(recorded.time_s, input_channels(recorded)),
        terms_(std::move(terms)) {
    select_channels(asset, recorded);
    start_ = Model::start(plant, asset, recorded);
    for (const PhysicsParameter& parameter : terms_.parameters) start_.parameters.push_back(parameter.setting.value);
    start_.initial_state.resize(start_.initial_state.size() + terms_.hidden_names.size(), 0.0);
    state_names_.insert(state_names_.end(), terms_.hidden_names.begin(), terms_.hidden_names.end());
    for (const ActiveTerm& term : terms_.active)
      if (term.hidden >= 0 && term.law->hidden->free_initial)
        slow_state_names_.push_back(terms_.hidden_names[static_cast<std::size_t>(term.hidden)]);
  }

  [[nodiscard]] const PlantDescription& plant() const override { return plant_; }
  [[nodiscard]] std::span<const std::string> channels() const override { return channel_names_; }
  [[nodiscard]] std::span<const std::string> state_names() const override { return state_names_; }
  [[nodiscard]] std::span<const std::string> slow_state_names() const override { return slow_state_names_; }
  [[nodiscard]] const ModelValues& start() const override { return start_; }
  [[nodiscard]] const RowMatrix& recorded() const override { return recorded_; }

  [[nodiscard]] std::span<const Site> sites() const override { return sites_of_plant(); }
  [[nodiscard]] std::span<const PhysicsParameter> physics_parameters() const override { return terms_.parameters; }

  [[nodiscard]] Result<SimulatedOutputs> run(const ModelValues& values, std::span<const FreeQuantity> free,
                                             const SimulationOptions& options,
                                             InjectedColumns* injected) const override {
    if (!terms_.parameters.empty() || injected != nullptr) return run_with_physics(values, free, options, injected);
    if (free.size() <= 4) return run_with<4>(values, free, options);
    if (free.size() <= 8) return run_with<8>(values, free, options);
    return run_with<12>(values, free, options);
  }

  /// Empty where the equations have none.
  [[nodiscard]] static std::span<const Site> sites_of_plant() {
    if constexpr (requires { Model::Equations::kSites; }) return Model::Equations::kSites;
    return {};
  }

 private:
  static std::vector<InputChannel> input_channels(const TimeSeries& recorded) {
    std::vector<InputChannel> channels;
    for (const auto& input : Model::kInputs)
      channels.push_back({recorded.find(input.name)->values, input.hold || recorded.input_hold});
    return channels;
  }

  void select_channels(const AssetConfig& asset, const TimeSeries& recorded) {
    for (std::size_t k = 0; k < Model::kOutputs.size(); ++k) {
      const std::string name(Model::kOutputs[k].channel);
      if (!recorded.has(name)) continue;
      const auto sensor = asset.sensors.find(name);
      const double time_constant =
          sensor != asset.sensors.end() ? sensor->second.time_constant_s : plant_.find_channel(name)->time_constant_s;
      channels_.push_back({static_cast<int>(k), time_constant});
      channel_names_.push_back(name);
    }
    const auto rows = static_cast<Eigen::Index>(recorded.time_s.size());
    recorded_.resize(rows, static_cast<Eigen::Index>(channels_.size()));
    for (std::size_t c = 0; c < channels_.size(); ++c)
      recorded_.col(static_cast<Eigen::Index>(c)) =
          Eigen::Map<const Eigen::VectorXd>(recorded.find(channel_names_[c])->values.data(), rows);
  }

  template <int Width>
  [[nodiscard]] Result<SimulatedOutputs> run_with(const ModelValues& values, std::span<const FreeQuantity> free,
                                                  const SimulationOptions& options) const {
    return Run<Width, false>(*this, values, free, options, nullptr).simulate(values);
  }
  /// With the laws in force and columns injected: in a translation unit of its own (plant_physics.hpp).
  [[nodiscard]] Result<SimulatedOutputs> run_with_physics(const ModelValues& values, std::span<const FreeQuantity> free,
                                                          const SimulationOptions& options,
                                                          InjectedColumns* injected) const;
  template <int Width, bool WithPhysics>
  class Run;

  const PlantDescription& plant_;
  std::vector<std::string> state_names_, slow_state_names_, channel_names_;
  std::vector<SimulatedChannel> channels_;
  RecordedInput input_;
  PhysicsTerms terms_;
  RowMatrix recorded_;
  ModelValues start_;
};

}  // namespace sealwatch

#include "services/common/model/plant_simulation_run.hpp"
