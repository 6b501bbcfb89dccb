#include <algorithm>
#include <cmath>
#include <utility>

#include "services/common/fmi/fmu_evaluator.hpp"

namespace sealwatch::fmi {
namespace {

/// Of a quantity's usual size, for central differences: both the curvature over it and the rounding of a binary that
/// computes in double are then some 1e-9 of the derivative.
constexpr double kDifference = 1e-7;

std::vector<double> state_steps(const FmuBlock& block) {
  std::vector<double> steps;
  for (std::size_t k = 0; k < block.states.size(); ++k)
    steps.push_back(kDifference * block.state_sizes[k] / std::abs(block.states[k].factor));
  return steps;
}

}  // namespace

Result<std::unique_ptr<FmuProcess>> ProcessPool::take(const FmuBlock& block, std::size_t slots,
                                                      const Deadline* deadline) {
  if (const auto why_none = lost_.given_up()) return fail(*why_none);
  std::vector<std::unique_ptr<FmuProcess>> gone;  // they take a while to end, in which nobody should wait
  {
    const std::scoped_lock lock(mutex_);
    const auto fits = std::ranges::find_if(
        idle_, [&](const auto& process) { return process->alive() && process->most_slots() >= slots; });
    if (fits != idle_.end()) {
      std::unique_ptr<FmuProcess> process = std::move(*fits);
      idle_.erase(fits);
      process->keep(deadline);
      return process;
    }
    gone.swap(idle_);  // too small, or of the process that this one is a copy of
  }
  return FmuProcess::start(block.file->name(), block.setup, slots, {}, deadline);
}

void ProcessPool::give_back(std::unique_ptr<FmuProcess> process) {
  lost_.note(*process);
  if (!process->alive()) return;
  process->keep(nullptr);
  const std::scoped_lock lock(mutex_);
  idle_.push_back(std::move(process));
}

Result<std::unique_ptr<RunningBlock>> RunningBlock::begin(const FmuBlock& block, std::shared_ptr<ProcessPool> pool,
                                                          const RuntimePoint& first,
                                                          const std::vector<BlockStart>& starts,
                                                          std::vector<double> steps) {
  std::unique_ptr<RunningBlock> running(new RunningBlock(block, std::move(pool), first.deadline, std::move(steps)));
  const std::size_t in_one = block.setup.once_per_process != 0 ? 1 : starts.size();
  // What the unit lays out until its stop time is to last for a recording that is longer than its maker's experiment.
  const double stop_s =
      std::isfinite(first.last_time_s) ? std::max(block.stop_time_s, first.last_time_s) : block.stop_time_s;
  for (std::size_t slot = 0; slot < starts.size(); slot += in_one)
    if (const Status begun = running->begin_process(first.time_s, stop_s, std::span(starts).subspan(slot, in_one));
        !begun)
      return fail(begun.error());
  if (running->beginning_.outcome.terminate) running->end_at(first.time_s);
  running->inputs_ = block.input_start;
  running->states_.resize(block.states.size());
  for (const Conversion& state : block.states) running->state_factors_.push_back(state.factor);
  return running;
}

namespace {

/// The group's start values, with those of its elements that the plant sets, behind the values of other instances.
void append(const std::vector<double>& start, const std::vector<Port>& ports, const std::vector<double>& values,
            std::vector<double>& all) {
  const std::size_t first = all.size();
  all.insert(all.end(), start.begin(), start.end());
  for (std::size_t k = 0; k < ports.size(); ++k) all[first + ports[k].place] = ports[k].unit.from_si(values[k]);
}

}  // namespace

Status RunningBlock::begin_process(double time_s, double stop_s, std::span<const BlockStart> starts) {
  auto process = pool_->take(block_, starts.size(), deadline_);
  if (!process) return fail(process.error());
  processes_.push_back(std::move(*process));
  const std::vector<double> differences = state_steps(block_);
  std::vector<double> input_differences = block_.input_sizes;
  for (double& step : input_differences) step *= kDifference;
  std::vector<double> inputs, parameters;
  for (const BlockStart& start : starts) {
    append(block_.input_start, block_.inputs, start.inputs, inputs);
    append(block_.parameter_start, block_.parameters, start.parameters, parameters);
  }
  auto beginning = processes_.back()->begin({.start_time_s = time_s,
                                             .stop_time_s = stop_s,
                                             .state_steps = differences,
                                             .input_steps = input_differences,
                                             .inputs = inputs,
                                             .slots = starts.size(),
                                             .parameters = parameters});
  if (!beginning) return fail(beginning.error());
  if (processes_.size() == 1)
    beginning_ = std::move(*beginning);
  else
    std::ranges::copy(beginning->states, std::back_inserter(beginning_.slot_states));
  return {};
}

RunningBlock::~RunningBlock() {
  for (auto& process : processes_) pool_->give_back(std::move(process));
}

bool RunningBlock::is_known(double time_s, const EvaluationRequest& wanted) const {
  return time_s == known_time_s_ && states_ == known_states_ && inputs_ == known_inputs_ &&
         wanted.by_state <= known_.by_state && wanted.by_input <= known_.by_input &&
         wanted.by_parameter <= known_.by_parameter;
}

const BlockValues* RunningBlock::at(double time_s, std::span<const double> states, std::span<const double> inputs,
                                    EvaluationRequest wanted) {
  set_point(states, inputs);
  if (steps_.empty()) wanted.by_parameter = 0;
  if (is_known(time_s, wanted)) return &values_;
  if (!processes_[0]->alive()) return nullptr;  // trouble_ says why
  if (time_s > ended_s_)
    return in_trouble("the FMU ends the simulation by itself at " + std::to_string(ended_s_) +
                      " s: end the recording there");
  if (block_.setup.co_simulation != 0) return step_to(time_s);
  const bool in_one = processes_.size() == 1;
  EvaluationRequest asked = wanted;
  if (!in_one) asked.by_parameter = 0;
  const auto values = processes_[0]->evaluate(time_s, states_, inputs_, asked);
  known_time_s_ = std::numeric_limits<double>::quiet_NaN();
  if (!values) return trouble_ = values.error().describe(), nullptr;
  convert(*values, asked);
  if (!derivatives_hold(time_s, asked)) return nullptr;
  if (wanted.by_parameter != 0 && !in_one && !differentiate_by_parameters(time_s)) return nullptr;
  known_time_s_ = time_s, known_states_ = states_, known_inputs_ = inputs_, known_ = wanted;
  return &values_;
}

const BlockValues* RunningBlock::step_to(double time_s) {
  const bool first = std::isnan(stepped_to_s_);
  if (first) stepped_to_s_ = time_s;
  const double step_s = is_jump(time_s - stepped_to_s_) ? 0.0 : time_s - stepped_to_s_;
  if (const std::string fault = fault_of_step(step_s); !fault.empty()) return in_trouble(fault);
  std::vector<double> during = inputs_;
  for (std::size_t k = 0; !first && k < block_.inputs.size(); ++k) {
    const std::size_t place = block_.inputs[k].place;
    during[place] = block_.held_inputs[k] ? known_inputs_[place] : 0.5 * (inputs_[place] + known_inputs_[place]);
  }
  const std::size_t variables = block_.variables.size(), outputs = elements(block_.setup.outputs);
  values_.z.assign(variables, 0.0);
  values_.by_state.resize(variables, 0);
  values_.by_input.resize(variables, block_.inputs.size());  // no site acts on an input
  values_.by_parameter.resize(variables, steps_.size());
  std::size_t slot = 0;
  for (auto& process : processes_) {
    const auto end = process->do_step(stepped_to_s_, std::max(0.0, step_s), during, inputs_);
    if (!end) return in_trouble(end.error().describe());
    if (slot == 0 && end->terminate) end_at(end->reached_s);
    const std::span<const double> values = end->outputs;
    for (std::size_t row = 0; row < values.size() / std::max<std::size_t>(1, outputs); ++row, ++slot)
      for (std::size_t k = 0; k < variables; ++k) {
        const auto& [place, unit] = block_.variables[k];
        const double value = unit.to_si(values[row * outputs + place]);
        if (slot == 0)
          values_.z[k] = value;
        else
          values_.by_parameter.row(k)[slot - 1] = (value - values_.z[k]) / steps_[slot - 1];
      }
  }
  if (step_s > 0.0) stepped_to_s_ = time_s;
  known_time_s_ = time_s, known_inputs_ = inputs_, known_states_ = states_, known_ = {1, 1, 1};
  return &values_;
}

void RunningBlock::end_at(double time_s) {
  constexpr double kRounding = 1e-9;  // of a step's end that was computed twice
  ended_s_ = std::min(ended_s_, time_s + kRounding * std::max(1.0, std::abs(time_s)));
}

// Two samples beside a jump are one communication point: what changes there are the inputs.
bool RunningBlock::is_jump(double step_s) const {
  constexpr double kJump = 1e-6;  // of the steps
  return step_s > 0.0 && step_s < kJump * step_s_;
}

std::string RunningBlock::fault_of_step(double step_s) {
  constexpr double kRounding = 1e-6;
  const Interface& interface = block_.file->interface();
  if (!(step_s > 0.0)) return "";
  if (step_s_ == 0.0) step_s_ = step_s;
  if (!interface.variable_steps && std::abs(step_s - step_s_) > kRounding * step_s_)
    return "the FMU does equal steps alone (canHandleVariableCommunicationStepSize), and the samples are " +
           std::to_string(step_s_) + " and " + std::to_string(step_s) + " s apart: bring them to equal distances";
  const double whole = interface.fixed_step_s > 0.0 ? step_s / interface.fixed_step_s : 1.0;
  if (std::abs(whole - std::round(whole)) > kRounding * whole || whole < 0.5)
    return "the FMU does steps of " + std::to_string(interface.fixed_step_s) +
           " s (fixedInternalStepSize), of which the distance of the samples, " + std::to_string(step_s) +
           " s, is not a whole number: bring the samples to such distances, or import it for Model Exchange";
  return "";
}

void RunningBlock::start(std::span<double> states, RuntimeMatrix& by_parameter) const {
  by_parameter.resize(states.size(), steps_.size());
  for (std::size_t k = 0; k < states.size(); ++k) {
    states[k] = block_.states[k].to_si(beginning_.states[k]);
    for (std::size_t slot = 0; slot < steps_.size(); ++slot) {
      const double other = beginning_.slot_states[slot * states.size() + k];
      by_parameter.row(k)[slot] = (block_.states[k].to_si(other) - states[k]) / steps_[slot];
    }
  }
}

bool RunningBlock::has_events() const {
  const bool held = block_.setup.continuous_inputs < block_.setup.inputs.size();
  return block_.setup.co_simulation == 0 &&
         (block_.setup.event_indicators > 0 || held || std::isfinite(beginning_.outcome.next_time_s) ||
          block_.file->interface().needs_completed_step);
}

bool RunningBlock::event_before(double time_s, std::span<const double> states, std::span<const double> inputs) {
  if (block_.setup.event_indicators == 0) return false;
  const BlockValues* values = at(time_s, states, inputs, {});
  return values != nullptr && values->signs != signs_;
}

bool RunningBlock::accept(double time_s, std::span<const double> states, std::span<const double> inputs) {
  if (!block_.file->interface().needs_completed_step) return false;
  set_point(states, inputs);
  const auto end = processes_[0]->completed_step(time_s, states_, inputs_);
  if (!end) trouble_ = end.error().describe();
  if (end && end->terminate) end_at(time_s);
  return end && end->event;
}

bool RunningBlock::pass_event(double time_s, std::span<double> states, std::span<const double> inputs) {
  set_point(states, inputs);
  for (std::size_t k = processes_.size(); k-- > 0;) {
    std::vector<double> after = states_;
    const auto outcome = processes_[k]->event(time_s, after, inputs_);
    if (!outcome) return trouble_ = outcome.error().describe(), false;
    if (k > 0) continue;
    if (outcome->terminate) end_at(time_s);
    beginning_.outcome = *outcome;
    for (std::size_t row = 0; row < after.size(); ++row) states[row] = block_.states[row].to_si(after[row]);
  }
  known_time_s_ = std::numeric_limits<double>::quiet_NaN();
  const BlockValues* values = at(time_s, states, inputs, {});
  if (values == nullptr) return false;
  signs_ = values->signs;
  return true;
}

void RunningBlock::set_point(std::span<const double> states, std::span<const double> inputs) {
  for (std::size_t k = 0; k < states.size(); ++k) states_[k] = block_.states[k].from_si(states[k]);
  for (std::size_t k = 0; k < block_.inputs.size(); ++k)
    inputs_[block_.inputs[k].place] = block_.inputs[k].unit.from_si(inputs[k]);
}

std::vector<double> RunningBlock::z_of(const Evaluation& values) const {
  std::vector<double> z;
  for (std::size_t k = 0; k < states_.size(); ++k) z.push_back(rate(k, values.derivatives[k]));
  for (const Port& variable : block_.variables) z.push_back(variable.unit.to_si(values.outputs[variable.place]));
  return z;
}

void RunningBlock::convert(const Evaluation& values, const EvaluationRequest& wanted) {
  const std::size_t states = states_.size(), variables = block_.variables.size(), outputs = values.outputs.size();
  values_.z = z_of(values);
  values_.signs.resize(values.indicators.size());
  for (std::size_t k = 0; k < values.indicators.size(); ++k) values_.signs[k] = values.indicators[k] > 0.0;
  if (wanted.by_state != 0) convert_jacobian(values.derivatives_by_state, values.outputs_by_state, states, true);
  if (wanted.by_input != 0) {
    const std::size_t known = states > 0    ? values.derivatives_by_input.size() / states
                              : outputs > 0 ? values.outputs_by_input.size() / outputs
                                            : 0;
    convert_jacobian(values.derivatives_by_input, values.outputs_by_input, known, false);
  }
  if (wanted.by_parameter == 0) return;
  values_.by_parameter.resize(states + variables, steps_.size());
  for (std::size_t slot = 0; slot < steps_.size(); ++slot) {
    const std::span<const double> other = values.parameter.subspan(slot * (states + outputs), states + outputs);
    for (std::size_t k = 0; k < states; ++k)
      values_.by_parameter.row(k)[slot] = rate(k, other[k] - values.derivatives[k]) / steps_[slot];
    for (std::size_t k = 0; k < variables; ++k) {
      const auto& [place, unit] = block_.variables[k];
      values_.by_parameter.row(states + k)[slot] =
          unit.factor * (other[states + place] - values.outputs[place]) / steps_[slot];
    }
  }
}

void RunningBlock::convert_jacobian(std::span<const double> derivatives, std::span<const double> outputs,
                                    std::size_t columns, bool of_states) {
  const std::size_t states = states_.size(), variables = block_.variables.size();
  const std::size_t known = of_states ? states : block_.inputs.size();
  RuntimeMatrix& matrix = of_states ? values_.by_state : values_.by_input;
  matrix.resize(states + variables, known);
  const auto convert_row = [&](const double* from, double factor, double* to) {
    for (std::size_t column = 0; of_states && column < known; ++column)
      to[column] = factor * from[column] / state_factors_[column];
    for (std::size_t column = 0; !of_states && column < known; ++column) {
      const auto& [place, unit] = block_.inputs[column];
      if (place < columns) to[column] = factor * from[place] / unit.factor;  // else it changes at events only
    }
  };
  for (std::size_t k = 0; k < states; ++k)
    convert_row(derivatives.data() + k * columns, block_.states[k].factor, matrix.row(k));
  for (std::size_t k = 0; k < variables; ++k) {
    const auto& [row, unit] = block_.variables[k];
    convert_row(outputs.data() + row * columns, unit.factor, matrix.row(states + k));
  }
}

bool RunningBlock::differentiate_by_parameters(double time_s) {
  const std::size_t states = states_.size(), variables = block_.variables.size();
  values_.by_parameter.resize(states + variables, steps_.size());
  for (std::size_t slot = 0; slot < steps_.size(); ++slot) {
    const auto other = processes_[slot + 1]->evaluate(time_s, states_, inputs_, {});
    if (!other) return trouble_ = other.error().describe(), false;
    for (std::size_t k = 0; k < states; ++k)
      values_.by_parameter.row(k)[slot] = (rate(k, other->derivatives[k]) - values_.z[k]) / steps_[slot];
    for (std::size_t k = 0; k < variables; ++k) {
      const auto& [place, unit] = block_.variables[k];
      values_.by_parameter.row(states + k)[slot] =
          (unit.to_si(other->outputs[place]) - values_.z[states + k]) / steps_[slot];
    }
  }
  return true;
}

}  // namespace sealwatch::fmi
