#include "services/common/fmi/fmu_process.hpp"

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <new>

#include "services/common/fmi/host_launch.hpp"

namespace sealwatch::fmi {
namespace {

std::string place_of(const char* what, double time_s) {
  if (std::isnan(time_s)) return what;
  std::string text = std::to_string(time_s);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return std::string(what) + " at t = " + text + " s";
}

}  // namespace

FmuProcess::FmuProcess(std::string file, Setup setup, std::size_t most_slots, const ProcessLimits& limits)
    : file_(std::move(file)),
      setup_(std::move(setup)),
      most_slots_(most_slots),
      limits_(limits),
      states_(elements(setup_.states)),
      inputs_(elements(setup_.inputs)),
      outputs_(elements(setup_.outputs)) {
  const std::size_t rows = states_ + outputs_, numbers = rows * (1 + states_ + inputs_ + most_slots_) +
                                                         setup_.event_indicators + 4 * (states_ + inputs_) +
                                                         most_slots_ * elements(setup_.parameters);
  std::size_t texts = setup_.library.size() + setup_.folder.size() + setup_.resources.size() + setup_.token.size();
  texts += setup_.constant_texts.size();
  for (const auto* handles :
       {&setup_.states, &setup_.derivatives, &setup_.parameters, &setup_.constants, &setup_.inputs, &setup_.outputs})
    texts += handles->size() * sizeof(Handle);
  memory_bytes_ = sizeof(SharedHeader) + (numbers + 64) * sizeof(double) + texts + 1024;
}

Result<std::unique_ptr<FmuProcess>> FmuProcess::start(const std::string& file, Setup setup, std::size_t most_slots,
                                                      const ProcessLimits& limits) {
  std::unique_ptr<FmuProcess> process(new FmuProcess(file, std::move(setup), most_slots, limits));
  if (const Status launched = process->launch(); !launched) return fail(launched.error());
  Packer packer = process->packer();
  put_setup(packer, process->setup_);
  const Status loaded = process->request(Operation::load, "loading the binary", limits.start_s);
  if (!loaded) return fail(loaded.error());
  return process;
}

Status FmuProcess::launch() {
  Result<LaunchedHost> host = launch_host(memory_bytes_, limits_.memory_bytes);
  if (!host) {
    Error error = host.error();
    error.file = file_;
    return fail(std::move(error));
  }
  header_ = new (host->memory) SharedHeader;
  header_->heap_bytes = memory_bytes_ - sizeof(SharedHeader);
  child_ = host->process, life_ = host->life, output_ = host->output;
  alive_ = true;
  return {};
}

FmuProcess::~FmuProcess() {
  if (alive_) {
    constexpr double kPatience_s = 2.0;  // a licence is given back, and the like
    static_cast<void>(request(Operation::end, "ending", kPatience_s));
    for (int look = 0; alive_ && look < 200 && waitpid(child_, nullptr, WNOHANG) == 0; ++look) usleep(1000);
  }
  int status = 0;
  if (child_ > 0) kill_and_reap(&status);
  if (header_ != nullptr) munmap(header_, memory_bytes_);
  for (const int descriptor : {life_, output_})
    if (descriptor >= 0) close(descriptor);
}

void FmuProcess::kill_and_reap(int* status) {
  alive_ = false;
  kill(child_, SIGKILL);
  while (waitpid(child_, status, 0) < 0 && errno == EINTR) {
  }
  child_ = -1;
}

std::span<std::byte> FmuProcess::heap() const {
  return {reinterpret_cast<std::byte*>(header_) + sizeof(SharedHeader), memory_bytes_ - sizeof(SharedHeader)};
}

Status FmuProcess::request(Operation operation, const char* what, double seconds, double time_s) {
  using Clock = std::chrono::steady_clock;
  if (!alive_) return fail(failure(place_of(what, time_s), "the process that ran the FMU has ended", "start anew"));
  const std::uint32_t number = header_->requests.load() + 1;
  header_->operation = operation;
  store_and_wake(header_->requests, number);
  constexpr double kLook_s = 0.02;  // how soon an end of the process is seen
  const auto begin = Clock::now();
  for (std::uint32_t last = number - 1; !wait_while(header_->answers, last, kLook_s);) {
    int status = 0;
    const pid_t gone = waitpid(child_, &status, WNOHANG);
    if (gone == child_) {
      alive_ = false, child_ = -1;
      if (header_->answers.load() == number) break;
      return fail(ended(place_of(what, time_s), status));
    }
    if (std::chrono::duration<double>(Clock::now() - begin).count() < seconds) continue;
    kill_and_reap(&status);
    return fail(failure(place_of(what, time_s),
                        "the FMU did not answer within " + std::to_string(std::lround(seconds)) + " s and was ended",
                        "its binary hangs: try it in the tool that made it" + printed()));
  }
  if (header_->status == AnswerStatus::ok) return {};
  std::array<char, kTextBytes> text{};
  std::copy_n(header_->text, kTextBytes - 1, text.begin());
  return fail(failure(place_of(what, time_s), text.data(), advice_of(operation) + printed()));
}

std::string FmuProcess::advice_of(Operation operation) const {
  const bool starts = operation == Operation::begin || operation == Operation::load;
  if (starts && !setup_.needed_tool.empty())
    return "it needs " + setup_.needed_tool +
           " on this machine to run (needsExecutionTool): install it, or export the model without that need";
  return operation == Operation::begin ? "a licence may be missing, or a parameter outside what the model allows"
                                       : "try the model in the tool that made it";
}

Error FmuProcess::failure(const std::string& what, std::string rule, std::string advice) const {
  return {.file = file_, .place = what, .value = {}, .rule = std::move(rule), .advice = std::move(advice)};
}

Error FmuProcess::ended(const std::string& what, int status) const {
  if (WIFSIGNALED(status))
    return failure(what, std::string("the FMU's binary crashed: ") + strsignal(WTERMSIG(status)),
                   "try it in the tool that made it" + printed());
  return failure(what, "the FMU's binary ended its process with status " + std::to_string(WEXITSTATUS(status)),
                 "try it in the tool that made it" + printed());
}

/// The end of what the binary printed.
std::string FmuProcess::printed() const {
  std::array<char, 400> text{};
  const off_t size = lseek(output_, 0, SEEK_END);
  const off_t from = std::max<off_t>(0, size - static_cast<off_t>(text.size()));
  const ssize_t got = size > 0 ? pread(output_, text.data(), text.size(), from) : 0;
  std::string last(text.data(), static_cast<std::size_t>(std::max<ssize_t>(0, got)));
  std::ranges::replace_if(
      last, [](unsigned char c) { return c < 0x20; }, ' ');
  last.erase(last.find_last_not_of(' ') + 1);
  return last.empty() ? "" : "; it printed: " + last;
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
  Packer packer = this->packer();
  packer.put(run.start_time_s);
  packer.put_list(run.state_steps);
  packer.put_list(run.input_steps);
  packer.put_list(run.inputs);
  packer.put(static_cast<std::uint64_t>(run.slots));
  packer.put_list(run.parameters);
  const Status status = request(Operation::begin, "the start of the model", limits_.start_s);
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
  const Status status = request(Operation::evaluate, "the derivatives", limits_.call_s, time_s);
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
  const Status status = request(Operation::event, "an event", limits_.call_s, time_s);
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
  const Status status = request(Operation::completed_step, "the end of a step", limits_.call_s, time_s);
  if (!status) return fail(status.error());
  Unpacker answer = unpacker();
  StepEnd end;
  end.event = answer.get<std::uint64_t>() != 0;
  end.terminate = answer.get<std::uint64_t>() != 0;
  return end;
}

Result<CoStepEnd> FmuProcess::do_step(double time_s, double step_s, std::span<const double> inputs) {
  Packer packer = this->packer();
  packer.put(time_s);
  packer.put(step_s);
  packer.put_numbers(inputs);
  const Status status = request(Operation::do_step, "a step", limits_.call_s, time_s);
  if (!status) return fail(status.error());
  Unpacker answer = unpacker();
  const std::span<const double> end = answer.numbers(2);
  return CoStepEnd{.outputs = answer.numbers(outputs_ * slots_), .terminate = end[0] != 0.0, .reached_s = end[1]};
}

}  // namespace sealwatch::fmi
