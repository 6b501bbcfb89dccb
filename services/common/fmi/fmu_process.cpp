#include "services/common/fmi/fmu_process.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace sealwatch::fmi {
namespace {

/// What all requests and answers take at most.
std::size_t heap_bytes(const Setup& setup, std::size_t most_slots) {
  const std::size_t states = elements(setup.states), inputs = elements(setup.inputs),
                    rows = states + elements(setup.outputs),
                    numbers = rows * (1 + states + inputs + most_slots) + setup.event_indicators +
                              4 * (states + inputs) + most_slots * (inputs + elements(setup.parameters));
  std::size_t texts = setup.library.size() + setup.folder.size() + setup.resources.size() + setup.token.size() +
                      setup.constant_texts.size() + setup.dependencies.size() * sizeof(std::uint32_t);
  for (const auto* handles :
       {&setup.states, &setup.derivatives, &setup.parameters, &setup.constants, &setup.inputs, &setup.outputs})
    texts += handles->size() * sizeof(Handle);
  return (numbers + 64) * sizeof(double) + texts + 1024;
}

}  // namespace

FmuProcess::FmuProcess(std::string file, Setup setup, std::size_t most_slots, const ProcessLimits& limits)
    : HostProcess(std::move(file), heap_bytes(setup, most_slots), limits),
      setup_(std::move(setup)),
      most_slots_(most_slots),
      states_(elements(setup_.states)),
      inputs_(elements(setup_.inputs)),
      outputs_(elements(setup_.outputs)) {
  needed_tool_ = setup_.needed_tool;
}

Result<std::unique_ptr<FmuProcess>> FmuProcess::start(const std::string& file, Setup setup, std::size_t most_slots,
                                                      const ProcessLimits& limits, const Deadline* deadline) {
  std::unique_ptr<FmuProcess> process(new FmuProcess(file, std::move(setup), most_slots, limits));
  process->keep(deadline);
  if (local_hosts()) {
    process->serve_here(process->setup_);
    return process;
  }
  if (const Status loaded = process->load(); !loaded) return fail(loaded.error());
  return process;
}

Status FmuProcess::load() {
  if (Status launched = launch(); !launched) return launched;
  Packer packer = this->packer();
  put_setup(packer, setup_);
  return request(Operation::load, "loading the binary", limits().start_s);
}

namespace {

Outcome outcome_of(Unpacker& answer) {
  Outcome outcome;
  outcome.terminate = answer.get<std::uint64_t>() != 0;
  outcome.values_changed = answer.get<std::uint64_t>() != 0;
  outcome.next_time_s = answer.get<double>();
  return outcome;
}

}  // namespace

Result<Beginning> FmuProcess::begin(const Run& run) {
  assert(run.slots <= most_slots_);
  if (std::exchange(begun_, true) && setup_.once_per_process != 0 && !local_hosts()) {
    end();
    if (const Status again = load(); !again) return fail(again.error());
  }
  Packer packer = this->packer();
  packer.put(run.start_time_s);
  packer.put(run.stop_time_s);
  packer.put_list(run.state_steps);
  packer.put_list(run.input_steps);
  packer.put_list(run.inputs);
  packer.put(static_cast<std::uint64_t>(run.slots));
  packer.put_list(run.parameters);
  const Status status = request(Operation::begin, "the start of the model", limits().start_s);
  if (!status) return fail(status.error());
  slots_ = run.slots;
  Unpacker answer = unpacker();
  Beginning beginning{.outcome = outcome_of(answer), .states = {}, .nominals = {}, .slot_states = {}};
  const auto take = [&](std::size_t count, std::vector<double>& list) {
    const std::span<double> numbers = answer.numbers(count);
    list.assign(numbers.begin(), numbers.end());
  };
  take(states_, beginning.states);
  take(states_, beginning.nominals);
  if (setup_.co_simulation == 0) take(states_ * (slots_ - 1), beginning.slot_states);
  return beginning;
}

Result<Evaluation> FmuProcess::evaluate(double time_s, std::span<const double> states, std::span<const double> inputs,
                                        const EvaluationRequest& wanted) {
  Packer packer = this->packer();
  packer.put(wanted);
  packer.put(time_s);
  packer.put_numbers(states);
  packer.put_numbers(inputs);
  const Status status = request(Operation::evaluate, "the derivatives", limits().call_s, time_s);
  if (!status) return fail(status.error());
  Unpacker answer = unpacker();
  Evaluation values;
  const auto numbers = [&](std::size_t count) -> std::span<const double> { return answer.numbers(count); };
  const std::size_t known = elements(std::span(setup_.inputs).first(setup_.continuous_inputs));
  values.derivatives = numbers(states_);
  values.outputs = numbers(outputs_);
  values.indicators = numbers(setup_.event_indicators);
  if (wanted.by_state != 0) {
    values.derivatives_by_state = numbers(states_ * states_);
    values.outputs_by_state = numbers(outputs_ * states_);
  }
  if (wanted.by_input != 0) {
    values.derivatives_by_input = numbers(states_ * known);
    values.outputs_by_input = numbers(outputs_ * known);
  }
  if (wanted.by_parameter != 0) values.parameter = numbers((states_ + outputs_) * (slots_ - 1));
  return values;
}

Result<Outcome> FmuProcess::event(double time_s, std::span<double> states, std::span<const double> inputs) {
  Packer packer = this->packer();
  packer.put(time_s);
  packer.put_numbers(states);
  packer.put_numbers(inputs);
  const Status status = request(Operation::event, "an event", limits().call_s, time_s);
  if (!status) return fail(status.error());
  Unpacker answer = unpacker();
  const Outcome outcome = outcome_of(answer);
  std::ranges::copy(answer.numbers(states_), states.begin());
  return outcome;
}

Result<StepEnd> FmuProcess::completed_step(double time_s, std::span<const double> states,
                                           std::span<const double> inputs) {
  Packer packer = this->packer();
  packer.put(time_s);
  packer.put_numbers(states);
  packer.put_numbers(inputs);
  const Status status = request(Operation::completed_step, "the end of a step", limits().call_s, time_s);
  if (!status) return fail(status.error());
  Unpacker answer = unpacker();
  StepEnd end;
  end.event = answer.get<std::uint64_t>() != 0;
  end.terminate = answer.get<std::uint64_t>() != 0;
  return end;
}

Result<CoStepEnd> FmuProcess::do_step(double time_s, double step_s, std::span<const double> during,
                                      std::span<const double> end_inputs) {
  Packer packer = this->packer();
  packer.put(time_s);
  packer.put(step_s);
  packer.put_numbers(during);
  packer.put_numbers(end_inputs);
  const Status status = request(Operation::do_step, "a step", limits().call_s, time_s);
  if (!status) return fail(status.error());
  Unpacker answer = unpacker();
  const std::span<const double> end = answer.numbers(2);
  return CoStepEnd{.outputs = answer.numbers(outputs_ * slots_), .terminate = end[0] != 0.0, .reached_s = end[1]};
}

}  // namespace sealwatch::fmi
