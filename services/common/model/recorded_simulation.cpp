#include "services/common/model/recorded_simulation.hpp"

#include <utility>

namespace sealwatch {

RecordedSimulation::RecordedSimulation(const PlantDescription& plant, PhysicsTerms terms)
    : plant_(plant), terms_(std::move(terms)) {}

void RecordedSimulation::select_channels(std::span<const OutputName> outputs, const AssetConfig& asset,
                                         const TimeSeries& recorded) {
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    const std::string& name = outputs[k].channel;
    if (!recorded.has(name)) continue;
    const auto sensor = asset.sensors.find(name);
    const double time_constant =
        sensor != asset.sensors.end() ? sensor->second.time_constant_s : plant_.find_channel(name)->time_constant_s;
    channels_.push_back({static_cast<int>(k), outputs[k].state, time_constant});
    channel_names_.push_back(name);
  }
  const auto rows = static_cast<Eigen::Index>(recorded.time_s.size());
  recorded_.resize(rows, static_cast<Eigen::Index>(channels_.size()));
  for (std::size_t c = 0; c < channels_.size(); ++c)
    recorded_.col(static_cast<Eigen::Index>(c)) =
        Eigen::Map<const Eigen::VectorXd>(recorded.find(channel_names_[c])->values.data(), rows);
}

void RecordedSimulation::set_states(std::vector<std::string> names, std::vector<std::string> slow, ModelValues start) {
  state_names_ = std::move(names);
  slow_state_names_ = std::move(slow);
  start_ = std::move(start);
  for (const PhysicsParameter& parameter : terms_.parameters) start_.parameters.push_back(parameter.setting.value);
  start_.initial_state.resize(start_.initial_state.size() + terms_.hidden_names.size(), 0.0);
  state_names_.insert(state_names_.end(), terms_.hidden_names.begin(), terms_.hidden_names.end());
  for (const ActiveTerm& term : terms_.active)
    if (term.hidden >= 0 && term.law->hidden->free_initial)
      slow_state_names_.push_back(terms_.hidden_names[static_cast<std::size_t>(term.hidden)]);
}

}  // namespace sealwatch
