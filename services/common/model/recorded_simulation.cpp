#include "services/common/model/recorded_simulation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace sealwatch {
namespace {

double& error_in(RecordingErrors& errors, SiteKind kind, std::size_t input) {
  if (kind == SiteKind::clock_rate) return errors.clock_rate;
  RecordingErrors::Input& of_input = errors.inputs[input];
  if (kind == SiteKind::input_gain) return of_input.gain;
  return kind == SiteKind::input_bias ? of_input.bias : of_input.delay_s;
}

/// Over what a law of the recording is differentiated: far above what the integrator errs by at kTight, and small
/// enough that the outputs follow it linearly.
double difference_step(const RecordedInput& recorded, SiteKind kind, std::size_t input) {
  constexpr double kGain = 2e-3, kOfRange = 2e-3, kOfInterval = 0.2, kRate = 2e-4;
  if (kind == SiteKind::clock_rate) return kRate;
  if (kind == SiteKind::input_gain) return kGain;
  if (kind == SiteKind::input_delay)
    return kOfInterval * (recorded.times().back() - recorded.times().front()) /
           static_cast<double>(recorded.times().size() - 1);
  const auto [least, largest] = std::ranges::minmax(recorded.channels()[input].values);
  const double size = std::max(largest - least, std::max(std::abs(largest), std::abs(least)));
  return kOfRange * (size > 0.0 ? size : 1.0);
}

constexpr double kTight = 1e-6;

}  // namespace

RecordedSimulation::RecordedSimulation(const PlantDescription& plant, PhysicsTerms terms,
                                       std::vector<std::string> input_names, RecordedInput input)
    : plant_(plant), terms_(std::move(terms)), input_names_(std::move(input_names)), input_(std::move(input)) {
  // A recording may be driven by another channel than the one whose law the asset has.
  std::erase_if(terms_.recording, [&](const RecordingTerm& term) {
    return !term.input.empty() && std::ranges::find(input_names_, term.input) == input_names_.end();
  });
}

RecordingErrors RecordedSimulation::errors_at(const ModelValues& values) const {
  RecordingErrors errors{.inputs = std::vector<RecordingErrors::Input>(input_names_.size())};
  for (const RecordingTerm& term : terms_.recording)
    error_in(errors, term.kind, input_index(term)) += values.parameters[term.parameter];
  return errors;
}

std::pair<double, double> RecordedSimulation::input_range(std::size_t input) const {
  const auto [least, largest] = std::ranges::minmax(input_.channels()[input].values);
  return {least, largest};
}

std::size_t RecordedSimulation::input_index(const RecordingTerm& term) const {
  return static_cast<std::size_t>(std::ranges::find(input_names_, term.input) - input_names_.begin());
}

Result<SimulatedOutputs> RecordedSimulation::run(const ModelValues& values, std::span<const FreeQuantity> free,
                                                 const SimulationOptions& options, InjectedColumns* injected) const {
  if (terms_.recording.empty()) return run_driven_by(input_, values, free, options, injected);
  auto outputs = run_driven_by(input_.without(errors_at(values)), values, free, options, injected);
  for (std::size_t k = 0; outputs && k < free.size(); ++k)
    for (const RecordingTerm& term : terms_.recording) {
      if (free[k].kind != FreeQuantity::Kind::parameter || free[k].index != term.parameter) continue;
      const Result<RowMatrix> column = recording_column(values, term.kind, input_index(term), options);
      if (!column) return fail(column.error());
      outputs->sensitivities.col(static_cast<Eigen::Index>(k)) = column->reshaped<Eigen::RowMajor>();
    }
  return outputs;
}

Result<RowMatrix> RecordedSimulation::recording_column(const ModelValues& values, SiteKind kind, std::size_t input,
                                                       const SimulationOptions& options) const {
  SimulationOptions tight = options;
  tight.relative_tolerance = std::min(options.relative_tolerance, kTight);
  const double step = difference_step(input_, kind, input);
  std::array<RowMatrix, 2> sides;
  for (const std::size_t side : {0, 1}) {
    RecordingErrors errors = errors_at(values);
    error_in(errors, kind, input) += side == 0 ? -step : step;
    auto outputs = run_driven_by(input_.without(errors), values, {}, tight, nullptr);
    if (!outputs) return fail(outputs.error());
    sides[side] = std::move(outputs->values);
  }
  return RowMatrix((sides[1] - sides[0]) / (2.0 * step));
}

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
