#include "services/common/model/runtime_simulation.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "services/common/model/measured_input.hpp"
#include "services/common/model/recording_run.hpp"
#include "services/common/model/runtime_run.hpp"
#include "services/common/model/runtime_system.hpp"
#include "services/common/model/simulation_plants.hpp"
#include "services/common/model/start_values.hpp"
#include "services/common/text/format.hpp"

namespace sealwatch {
namespace {

std::vector<InputChannel> input_channels(const RuntimePlant& plant, const TimeSeries& recorded) {
  std::vector<InputChannel> channels;
  for (const RuntimeInput& input : plant.inputs) {
    const std::vector<double>& values = recorded.find(input.channel)->values;
    const bool hold = input.course == InputCourse::held || recorded.input_hold;
    if (input.smoothing_s > 0.0) {
      SmoothedInput smoothed = smoothed_input(recorded.time_s, values, input.smoothing_s);
      channels.push_back({std::move(smoothed.values), false, std::move(smoothed.slopes)});
    } else {
      const bool spline = input.course == InputCourse::band_limited && !hold;
      if (spline) {
        channels.push_back({values, false, spline_slopes(recorded.time_s, values), true});
        continue;
      }
      const bool averaged = input.course == InputCourse::averaged && !hold;
      channels.push_back({averaged ? means_of_neighbours(values) : values, hold});
    }
  }
  return channels;
}

/// Where a run begins, without what laws add there.
class FirstPoint {
 public:
  FirstPoint(const RuntimePlant& plant, const PlantDescription& description, const RecordedInput& input,
             const ModelValues& values, const Deadline* deadline)
      : deadline_(deadline),
        time_s_(input.times().front()),
        last_time_s_(input.times().back() + longest_step_s(input.times())),  // a step may lead beyond the last sample
        states_(values.initial_state.begin(),
                values.initial_state.begin() + static_cast<std::ptrdiff_t>(plant.states.size())),
        parameters_(effective_parameters(description, values)),
        added_(description.sites.size(), 0.0) {
    for (std::size_t k = 0, cursor = 0; k < plant.inputs.size(); ++k) {
      inputs_.push_back(input.value(k, time_s_, 0, cursor));
      rates_.push_back(input.slope(k, time_s_, cursor));
    }
  }
  [[nodiscard]] RuntimePoint point() const {
    return {.time_s = time_s_,
            .states = states_,
            .inputs = inputs_,
            .input_rates = rates_,
            .parameters = parameters_,
            .added = added_,
            .last_time_s = last_time_s_,
            .deadline = deadline_};
  }

 private:
  const Deadline* deadline_;
  double time_s_, last_time_s_;
  std::vector<double> states_, parameters_, added_, inputs_, rates_;
};

std::vector<std::string> input_names(const RuntimePlant& plant) {
  std::vector<std::string> names;
  for (const RuntimeInput& input : plant.inputs) names.push_back(input.channel);
  return names;
}

double mean_distance_s(const std::vector<double>& times) {
  return (times.back() - times.front()) / static_cast<double>(times.size() - 1);
}

/// The first output that is no number, or else that its derivatives are none.
tl::unexpected<Error> not_finite(const PlantSimulation& simulation, const SimulatedOutputs& outputs,
                                 std::span<const double> times, std::string trouble) {
  Error error{.file = {},
              .place = {},
              .value = std::move(trouble),
              .rule = "plant " + simulation.plant().name +
                      " gave a derivative that is not a finite number, though its outputs are finite: of an FMU, its "
                      "directional derivatives may be wrong there",
              .advice =
                  "check its equations where something is divided by zero or a root is taken of what may be negative, "
                  "or export the FMU without directional derivatives"};
  for (Eigen::Index row = 0; row < outputs.values.rows(); ++row)
    for (Eigen::Index channel = 0; channel < outputs.values.cols(); ++channel) {
      if (std::isfinite(outputs.values(row, channel))) continue;
      const auto sample = static_cast<std::size_t>(row);
      error.place = "output " + simulation.channels()[static_cast<std::size_t>(channel)];
      if (sample < times.size()) error.place += text::format(" at t = {:.6g} s", times[sample]);
      error.value = std::isnan(outputs.values(row, channel)) ? "nan" : "infinite";
      error.rule = "plant " + simulation.plant().name + " gave an output that is not a finite number";
      error.advice =
          "check what it is computed from: in an expression, a division by zero or a root of what may be negative; in "
          "an FMU, the model in the tool that made it";
      return fail(std::move(error));
    }
  return fail(std::move(error));
}

/// Fills in the states that start where the equations say.
Status start_by_equations(const RuntimePlant& plant, const PlantDescription& description, const TimeSeries& recorded,
                          ModelValues& start) {
  if (std::ranges::none_of(plant.states, &RuntimeState::by_equations)) return {};
  const RecordedInput input(recorded.time_s, input_channels(plant, recorded));
  const FirstPoint first(plant, description, input, start, nullptr);
  const auto evaluator = plant.equations->evaluator(first.point(), {});
  if (!evaluator) return fail(evaluator.error());
  std::vector<double> states = start.initial_state;
  RuntimeMatrix unused;
  if (!(*evaluator)->start(states, unused)) return fail((*evaluator)->trouble());
  for (std::size_t k = 0; k < states.size(); ++k)
    if (plant.states[k].by_equations) start.initial_state[k] = states[k];
  return {};
}

}  // namespace

RuntimePlantSimulation::RuntimePlantSimulation(std::shared_ptr<const RuntimePlant> plant,
                                               const PlantDescription& description, const TimeSeries& recorded,
                                               PhysicsTerms terms)
    : RecordedSimulation(description, std::move(terms), input_names(*plant),
                         {recorded.time_s, input_channels(*plant, recorded)}),
      runtime_(std::move(plant)) {}

Result<std::unique_ptr<PlantSimulation>> RuntimePlantSimulation::create(std::shared_ptr<const RuntimePlant> plant,
                                                                        const PlantDescription& description,
                                                                        const AssetConfig& asset,
                                                                        const TimeSeries& recorded,
                                                                        PhysicsTerms terms) {
  std::unique_ptr<RuntimePlantSimulation> simulation(
      new RuntimePlantSimulation(plant, description, recorded, std::move(terms)));
  std::vector<OutputName> outputs;
  for (const auto& [channel, state] : plant->outputs) outputs.push_back({channel, state});
  simulation->select_channels(outputs, asset, recorded);
  ModelValues start{.parameters = parameter_values(description, asset), .load_factor = 0.0, .initial_state = {}};
  Result<std::vector<double>> state = plant->equations->initial_state(start.parameters, recorded);
  if (!state) return fail(state.error());
  start.initial_state = std::move(*state);
  if (const Status known = start_by_equations(*plant, description, recorded, start); !known) return fail(known.error());
  std::vector<std::string> names, slow, at_rest;
  for (std::size_t k = 0; k < description.states.size(); ++k) {
    names.push_back(description.states[k].name);
    if (plant->states[k].slow)
      slow.push_back(description.states[k].name);
    else if (!plant->states[k].settles)
      at_rest.push_back(description.states[k].name);
  }
  simulation->set_states(std::move(names), std::move(slow), std::move(start), at_rest);
  static std::atomic<std::uint64_t> count = 0;
  if (plant->equations->runs_elsewhere())
    simulation->told_ = std::make_unique<const Told>(Told{.asset = asset, .recorded = recorded, .number = ++count});
  return simulation;
}

Result<SimulatedOutputs> RuntimeEquations::run(const RuntimeRun&) const {
  return fail("these equations run nothing elsewhere");
}

Result<SimulatedOutputs> RuntimePlantSimulation::run_driven_by(const RecordedInput& input, const ModelValues& values,
                                                               std::span<const FreeQuantity> free,
                                                               const SimulationOptions& options,
                                                               InjectedColumns* injected) const {
  if (told_)
    return runtime_->equations->run({.simulation = told_->number,
                                     .asset = told_->asset,
                                     .recorded = told_->recorded,
                                     .channels = channels().size(),
                                     .input = input,
                                     .values = values,
                                     .free = free,
                                     .options = options,
                                     .injected = injected,
                                     .sites = plant().sites.size()});
  FreeColumns columns = free_columns(plant(), values, free);
  const FirstPoint first(*runtime_, plant(), input, values, options.deadline);
  auto evaluator = runtime_->equations->evaluator(first.point(), columns.differentiated);
  if (!evaluator) return fail(evaluator.error());
  RuntimeSystem system(*runtime_, std::move(*evaluator), input, terms(), values, std::move(columns), injected);
  // Laws in an output act between samples at once: the steps follow the samples.
  SimulationOptions stepping = options;
  if (runtime_->equations->outputs_see_added() && injected != nullptr)
    stepping.maximum_step_s = std::min(options.maximum_step_s, mean_distance_s(input.times()));
  auto [outputs, stopped_by_event] = run_over_recording(*this, input, system, values, free, stepping, injected);
  if (stopped_by_event) {
    if (injected == nullptr) return run_by_differences(input, values, free, options);
    return fail("plant " + plant().name + " jumps at events, across which missing physics cannot be looked for",
                "fit and validate work; a model without such events (friction and stops rounded) can be explained");
  }
  if (outputs && !(outputs->values.allFinite() && outputs->sensitivities.allFinite()))
    return system.said().empty() ? not_finite(*this, *outputs, input.times(), system.trouble())
                                 : fail(went_no_further({}, system.said()));
  return std::move(outputs);  // what a structured binding names is copied else
}

namespace {

constexpr double kAlike = 0.5;
bool are_alike(double left, double right) {
  return std::abs(right - left) <= kAlike * (std::abs(right) + std::abs(left));
}

/// The slope at a sample from those on both of its sides. Where a change of the parameter moves a jump over the sample, one
/// of them is the jump's height and no slope: the other one counts, which is the smaller.
double beside_jumps(double left, double right) {
  if (are_alike(left, right)) return 0.5 * (left + right);
  return std::abs(left) < std::abs(right) ? left : right;
}

/// Whether a channel's jumps are moved over so many samples that both sides of one are hit. Differences of next to
/// nothing are none.
bool moves_jumps_too_far(const RowMatrix& left, const RowMatrix& right) {
  constexpr double kNothing = 1e-2, kMost = 0.02;  // of the largest; of the samples
  for (Eigen::Index channel = 0; channel < left.cols(); ++channel) {
    const auto one = left.col(channel), other = right.col(channel);
    const double least = kNothing * std::max(one.cwiseAbs().maxCoeff(), other.cwiseAbs().maxCoeff());
    double moved = 0.0;
    for (Eigen::Index row = 0; row < one.size(); ++row)
      if (std::max(std::abs(one(row)), std::abs(other(row))) > least && !are_alike(one(row), other(row))) moved += 1.0;
    if (moved > kMost * static_cast<double>(one.size())) return true;
  }
  return false;
}

}  // namespace

// A step is far above the integration's errors, and central differences err by its square. After many jumps a small one
// moves the last of them by many samples: then it is a tenth.
Result<SimulatedOutputs> RuntimePlantSimulation::run_by_differences(const RecordedInput& input,
                                                                    const ModelValues& values,
                                                                    std::span<const FreeQuantity> free,
                                                                    const SimulationOptions& options) const {
  constexpr double kLargest = 1e-3, kSmallest = 1e-5;  // share of the value
  constexpr double kErrors = 1e-4;                     // of the share
  Result<SimulatedOutputs> outputs;
  RowMatrix sensitivities;
  const auto changed_by = [&](const FreeQuantity& quantity, double step, const SimulationOptions& tight) {
    ModelValues changed = values;
    quantity.in(changed) += step;
    return run_driven_by(input, changed, {}, tight, nullptr);
  };
  double share = 10.0 * kLargest;
  for (bool too_far = true; too_far;) {
    share /= 10.0, too_far = false;
    SimulationOptions tight = options;
    tight.relative_tolerance = std::min(options.relative_tolerance, kErrors * share);
    outputs = run_driven_by(input, values, {}, tight, nullptr);
    if (!outputs) return outputs;
    const RowMatrix& here = outputs->values;
    sensitivities.resize(here.size(), std::ssize(free));
    for (std::size_t k = 0; k < free.size() && !too_far; ++k) {
      const double value = std::abs(free[k].in(values)), step = share * (value > 0.0 ? value : 1.0);
      const auto above = changed_by(free[k], step, tight), below = changed_by(free[k], -step, tight);
      if (!above) return above;
      if (!below) return below;
      const RowMatrix left = (here - below->values) / step, right = (above->values - here) / step;
      too_far = share > kSmallest && moves_jumps_too_far(left, right);
      for (Eigen::Index row = 0; row < here.size(); ++row)
        sensitivities(row, static_cast<Eigen::Index>(k)) = beside_jumps(left.data()[row], right.data()[row]);
    }
  }
  outputs->sensitivities = std::move(sensitivities);
  return outputs;
}

bool may_jump(const PlantSimulation& simulation) {
  const auto* runtime = dynamic_cast<const RuntimePlantSimulation*>(&simulation);
  return runtime != nullptr && runtime->runs_elsewhere();
}

Status add_plant(RuntimePlant plant) {
  const auto shared = std::make_shared<const RuntimePlant>(std::move(plant));
  PlantSimulator simulator{.model = shared->description.name, .inputs = {}, .simulate = nullptr};
  for (const RuntimeInput& input : shared->inputs) simulator.inputs.push_back(input.channel);
  simulator.simulate = [shared](const PlantDescription& description, const AssetConfig& asset,
                                const TimeSeries& recorded, PhysicsTerms terms) {
    return RuntimePlantSimulation::create(shared, description, asset, recorded, std::move(terms));
  };
  simulator.whole = shared->whole;
  return add_plant(shared->description, std::move(simulator));
}

}  // namespace sealwatch
