#include "services/common/model/recorded_simulation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sealwatch/signal/noise_floor.hpp"

namespace sealwatch {
namespace {

/// Adds a law of that size. A channel that drives the simulation may be measured itself (the flow of `eha`): its
/// sensor's errors are taken off it, a lag as the delay that it nearly is.
void add_error(RecordingErrors& errors, SiteKind kind, std::size_t input, double size) {
  if (kind == SiteKind::clock_rate) {
    errors.clock_rate += size;
    return;
  }
  RecordingErrors::Input& acted = errors.inputs[input];
  if (kind == SiteKind::input_gain) acted.gain += size;
  if (kind == SiteKind::input_bias) acted.bias += size;
  if (kind == SiteKind::input_delay) acted.delay_s += size;
  if (kind == SiteKind::input_clock_rate) acted.clock_rate += size;
  if (kind == SiteKind::sensor_gain) acted.gain += 1.0 / (1.0 + size) - 1.0;
  if (kind == SiteKind::sensor_bias) acted.zero += size;
  if (kind == SiteKind::sensor_lag) acted.delay_s -= size;
}

/// Over what a law of the recording is differentiated: far above what the integrator errs by at kTight, and small
/// enough that the outputs follow it linearly.
double difference_step(const RecordedInput& recorded, SiteKind kind, std::size_t input) {
  constexpr double kGain = 2e-3, kOfRange = 2e-3, kOfInterval = 0.2, kRate = 2e-4;
  if (kind == SiteKind::clock_rate || kind == SiteKind::input_clock_rate) return kRate;
  if (kind == SiteKind::input_gain || kind == SiteKind::sensor_gain) return kGain;
  if (kind == SiteKind::input_delay || kind == SiteKind::sensor_lag)
    return kOfInterval * (recorded.times().back() - recorded.times().front()) /
           static_cast<double>(recorded.times().size() - 1);
  const auto [least, largest] = std::ranges::minmax(recorded.channels()[input].values);
  const double size = std::max(largest - least, std::max(std::abs(largest), std::abs(least)));
  return kOfRange * (size > 0.0 ? size : 1.0);
}

constexpr double kTight = 1e-7;

// 1 + gain, per channel.
Eigen::VectorXd gains_of(const ModelValues& values, Eigen::Index channels) {
  return 1.0 + Eigen::Map<const Eigen::ArrayXd>(values.sensor_gain.data(), channels);
}

// y = (1 + g) z + b of each channel: dy/dtheta = (1 + g) dz/dtheta,  dy/dg = z,  dy/db = 1. `outputs` holds z and the
// columns of what is free and not of a sensor, then the injected ones.
void read_by_sensors(const ModelValues& values, std::span<const FreeQuantity> free, SimulatedOutputs& outputs) {
  const auto exact = [](double error) { return error == 0.0; };
  const Eigen::Index channels = outputs.values.cols(), samples = outputs.values.rows();
  const auto reads = [&](const FreeQuantity& one) {
    return one.is_of_sensor() && static_cast<Eigen::Index>(one.index) < channels;
  };
  if (std::ranges::none_of(free, reads) && std::ranges::all_of(values.sensor_gain, exact) &&
      std::ranges::all_of(values.sensor_offset, exact))
    return;
  const Eigen::VectorXd gain = gains_of(values, channels);
  const auto of_sensors = std::ranges::count_if(free, reads);
  RowMatrix all = RowMatrix::Zero(samples * channels, outputs.sensitivities.cols() + of_sensors);
  std::vector<Eigen::Index> place;  // of each column that is not a sensor's
  for (std::size_t k = 0; k < free.size(); ++k)
    if (!reads(free[k])) place.push_back(static_cast<Eigen::Index>(k));
  while (std::ssize(place) < outputs.sensitivities.cols()) place.push_back(std::ssize(place) + of_sensors);
  for (Eigen::Index row = 0; row < all.rows(); ++row)
    for (std::size_t k = 0; k < place.size(); ++k)
      all(row, place[k]) = gain(row % channels) * outputs.sensitivities(row, static_cast<Eigen::Index>(k));
  for (std::size_t k = 0; k < free.size(); ++k) {
    if (!reads(free[k])) continue;
    const auto channel = static_cast<Eigen::Index>(free[k].index);
    const bool of_gain = free[k].kind == FreeQuantity::Kind::sensor_gain;
    for (Eigen::Index sample = 0; sample < samples; ++sample)
      all(sample * channels + channel, static_cast<Eigen::Index>(k)) = of_gain ? outputs.values(sample, channel) : 1.0;
  }
  outputs.sensitivities = std::move(all);
  outputs.values *= gain.asDiagonal();
  outputs.values.rowwise() += Eigen::Map<const Eigen::RowVectorXd>(values.sensor_offset.data(), channels);
}

}  // namespace

RecordedSimulation::RecordedSimulation(const PlantDescription& plant, PhysicsTerms terms,
                                       std::vector<std::string> input_names, RecordedInput input)
    : plant_(plant), terms_(std::move(terms)), input_names_(std::move(input_names)), input_(std::move(input)) {
  // A recording may be driven by another channel than the one whose law the asset has, or by one that is measured.
  const auto drives = [&](const std::string& channel) {
    return std::ranges::find(input_names_, channel) != input_names_.end();
  };
  std::erase_if(terms_.recording,
                [&](const RecordingTerm& term) { return !term.input.empty() && !drives(term.input); });
  for (const SensorTerm& term : terms_.sensors)
    if (drives(term.channel) && term.kind < SiteKind::sensor_drift)
      terms_.recording.push_back({term.kind, term.channel, term.parameter});
}

RecordingErrors RecordedSimulation::errors_at(const ModelValues& values) const {
  RecordingErrors errors{.inputs = std::vector<RecordingErrors::Input>(input_names_.size())};
  for (const RecordingTerm& term : terms_.recording)
    add_error(errors, term.kind, term.kind == SiteKind::clock_rate ? 0 : input_index(term.input),
              values.parameters[term.parameter]);
  for (std::size_t k = channel_names_.size(); k < sensor_names_.size(); ++k) {
    add_error(errors, SiteKind::sensor_gain, input_index(sensor_names_[k]), values.sensor_gain[k]);
    add_error(errors, SiteKind::sensor_bias, input_index(sensor_names_[k]), values.sensor_offset[k]);
  }
  return errors;
}

std::pair<double, double> RecordedSimulation::initial_range(std::string_view state) const {
  for (const ActiveTerm& term : terms_.active)
    if (term.hidden >= 0 && terms_.hidden_names[static_cast<std::size_t>(term.hidden)] == state)
      return {term.law->hidden->least, term.law->hidden->most};
  return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
}

std::pair<double, double> RecordedSimulation::input_range(std::size_t input) const {
  const auto [least, largest] = std::ranges::minmax(input_.channels()[input].values);
  return {least, largest};
}

std::size_t RecordedSimulation::input_index(const std::string& name) const {
  return static_cast<std::size_t>(std::ranges::find(input_names_, name) - input_names_.begin());
}

std::vector<RecordedSimulation::Differentiated> RecordedSimulation::of_recording(
    const ModelValues& values, std::span<const FreeQuantity> free) const {
  std::vector<Differentiated> all;
  for (std::size_t k = 0; k < free.size(); ++k) {
    const FreeQuantity& one = free[k];
    if (one.is_of_sensor() && !is_of_output(one))
      all.push_back(
          {.free = k,
           .law = {one.kind == FreeQuantity::Kind::sensor_gain ? SiteKind::sensor_gain : SiteKind::sensor_bias,
                   input_index(sensor_names_[one.index])},
           .size = one.in(values)});
    for (const RecordingTerm& term : terms_.recording)
      if (one.kind == FreeQuantity::Kind::parameter && one.index == term.parameter)
        all.push_back({.free = k,
                       .law = {term.kind, input_index(term.input)},
                       .size = values.parameters[term.parameter],
                       .parameter = term.parameter});
  }
  return all;
}

Result<SimulatedOutputs> RecordedSimulation::run(const ModelValues& values, std::span<const FreeQuantity> free,
                                                 const SimulationOptions& options, InjectedColumns* injected) const {
  std::vector<FreeQuantity> of_plant;
  std::ranges::copy_if(free, std::back_inserter(of_plant),
                       [&](const FreeQuantity& one) { return !one.is_of_sensor() || !is_of_output(one); });
  Result<SimulatedOutputs> outputs = run_exact(values, of_plant, options, injected);
  if (outputs) read_by_sensors(values, free, *outputs);
  return outputs;
}

Result<SimulatedOutputs> RecordedSimulation::run_exact(const ModelValues& values, std::span<const FreeQuantity> free,
                                                       const SimulationOptions& options,
                                                       InjectedColumns* injected) const {
  if (terms_.recording.empty() && sensor_names_.size() == channel_names_.size())
    return run_driven_by(input_, values, free, options, injected);
  const RecordingErrors errors = errors_at(values);
  std::vector<FreeQuantity> seen(free.begin(), free.end());
  const std::vector<Differentiated> by_laws = of_recording(values, free);
  const auto by = [&](const Differentiated& one) { return by_recording(one.law, errors, one.size); };
  if (differentiates_by_recording())
    for (const Differentiated& one : by_laws) seen[one.free] = by(one).quantity;
  auto outputs = run_driven_by(input_.without(errors), values, seen, options, injected);
  for (const Differentiated& one : by_laws) {
    if (!outputs) return outputs;
    auto column = outputs->sensitivities.col(static_cast<Eigen::Index>(one.free));
    if (differentiates_by_recording()) {
      column *= by(one).factor;
      continue;
    }
    const Result<RowMatrix> difference = this->difference(values, one.law, one.parameter, options);
    if (!difference) return fail(difference.error());
    column = difference->reshaped<Eigen::RowMajor>();
  }
  return outputs;
}

// What is added to the errors by add_error(), differentiated.
RecordedSimulation::ByRecording RecordedSimulation::by_recording(RecordingLaw law, const RecordingErrors& errors,
                                                                 double size) const {
  using Kind = FreeQuantity::Kind;
  switch (law.kind) {
    case SiteKind::clock_rate:
      return {{Kind::clock_rate, 0}};
    case SiteKind::input_bias:
      return {{Kind::input_bias, law.input}};
    case SiteKind::input_delay:
      return {{Kind::input_delay, law.input}};
    case SiteKind::input_clock_rate:
      return {{Kind::input_clock_rate, law.input}};
    case SiteKind::sensor_gain:
      return {{Kind::input_gain, law.input}, -1.0 / ((1.0 + size) * (1.0 + size))};
    case SiteKind::sensor_bias:
      return {{Kind::input_bias, law.input}, -(1.0 + errors.inputs[law.input].gain)};
    case SiteKind::sensor_lag:
      return {{Kind::input_delay, law.input}, -1.0};
    default:
      return {{Kind::input_gain, law.input}};
  }
}

Result<RowMatrix> RecordedSimulation::recording_columns(const ModelValues& values, std::span<const RecordingLaw> laws,
                                                        const SimulationOptions& options) const {
  const Eigen::Index channels = recorded_.cols(), columns = std::ssize(laws);
  RowMatrix all(recorded_.size(), columns);
  if (laws.empty()) return all;
  if (differentiates_by_recording()) {
    const RecordingErrors errors = errors_at(values);
    std::vector<FreeQuantity> free;
    for (const RecordingLaw& law : laws) free.push_back(by_recording(law, errors, 0.0).quantity);
    auto outputs = run_driven_by(input_.without(errors), values, free, options, nullptr);
    if (!outputs) return fail(outputs.error());
    all = std::move(outputs->sensitivities);
    for (Eigen::Index k = 0; k < columns; ++k)
      all.col(k) *= by_recording(laws[static_cast<std::size_t>(k)], errors, 0.0).factor;
  } else {
    for (Eigen::Index k = 0; k < columns; ++k) {
      const Result<RowMatrix> column =
          difference(values, laws[static_cast<std::size_t>(k)], values.parameters.size(), options);
      if (!column) return fail(column.error());
      all.col(k) = column->reshaped<Eigen::RowMajor>();
    }
  }
  const Eigen::VectorXd gains = gains_of(values, channels);
  for (Eigen::Index row = 0; row < all.rows(); ++row) all.row(row) *= gains(row % channels);
  return all;
}

// `parameter`: the law's, where it is in force; else beyond the last.
Result<RowMatrix> RecordedSimulation::difference(const ModelValues& values, RecordingLaw law, std::size_t parameter,
                                                 const SimulationOptions& options) const {
  SimulationOptions tight = options;
  tight.relative_tolerance = std::min(options.relative_tolerance, kTight);
  const double step = difference_step(input_, law.kind, law.input);
  std::array<RowMatrix, 2> sides;
  for (const std::size_t side : {0, 1}) {
    ModelValues changed = values;
    const double by = side == 0 ? -step : step;
    if (parameter < changed.parameters.size()) changed.parameters[parameter] += by;
    RecordingErrors errors = errors_at(changed);
    if (parameter >= changed.parameters.size()) add_error(errors, law.kind, law.input, by);
    auto outputs = run_driven_by(input_.without(errors), values, {}, tight, nullptr);
    if (!outputs) return fail(outputs.error());
    sides[side] = std::move(outputs->values);
  }
  return RowMatrix((sides[1] - sides[0]) / (2.0 * step));
}

void RecordedSimulation::add_sensor(const std::string& channel, const AssetConfig& asset) {
  const auto sensor = asset.sensors.find(channel);
  sensor_names_.push_back(channel);
  sensor_gain_.push_back(sensor != asset.sensors.end() ? sensor->second.gain_error : 0.0);
  sensor_offset_.push_back(sensor != asset.sensors.end() ? sensor->second.offset_error : 0.0);
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
    add_sensor(name, asset);
  }
  for (const std::string& name : input_names_)
    if (recorded.has(name) && !plant_.find_channel(name)->input) add_sensor(name, asset);
  const auto rows = static_cast<Eigen::Index>(recorded.time_s.size());
  recorded_.resize(rows, static_cast<Eigen::Index>(channels_.size()));
  for (std::size_t c = 0; c < channels_.size(); ++c)
    if (const std::vector<double>& values = recorded.find(channel_names_[c])->values; values.empty())
      recorded_.col(static_cast<Eigen::Index>(c)).setZero();  // to be simulated alone
    else
      recorded_.col(static_cast<Eigen::Index>(c)) = Eigen::Map<const Eigen::VectorXd>(values.data(), rows);
}

const std::vector<double>& RecordedSimulation::recorded_noise() const {
  std::call_once(noise_is_known_, [this] {
    for (const auto& column : recorded_.colwise()) {
      const std::vector<double> values(column.begin(), column.end());
      noise_.push_back(signal::estimate_noise_floor(values, input_.times()).standard_deviation);
    }
  });
  return noise_;
}

void RecordedSimulation::set_states(std::vector<std::string> names, std::vector<std::string> slow, ModelValues start,
                                    const std::vector<std::string>& at_rest) {
  state_names_ = std::move(names);
  slow_state_names_ = std::move(slow);
  start_ = std::move(start);
  start_.sensor_gain = sensor_gain_;
  start_.sensor_offset = sensor_offset_;
  for (const PhysicsParameter& parameter : terms_.parameters) start_.parameters.push_back(parameter.setting.value);
  start_.initial_state.resize(start_.initial_state.size() + terms_.hidden_names.size(), 0.0);
  state_names_.insert(state_names_.end(), terms_.hidden_names.begin(), terms_.hidden_names.end());
  for (const ActiveTerm& term : terms_.active)
    if (term.hidden >= 0 && term.law->hidden->free_initial)
      slow_state_names_.push_back(terms_.hidden_names[static_cast<std::size_t>(term.hidden)]);
  free_state_names_ = slow_state_names_;
  free_state_names_.insert(free_state_names_.end(), at_rest.begin(), at_rest.end());
}

}  // namespace sealwatch
