#include "services/common/fmi/hosted_runs.hpp"

#include <algorithm>
#include <array>

namespace sealwatch::fmi {
namespace {

/// Simulations that a process keeps: those of several recordings take turns.
constexpr std::size_t kMostSimulations = 24;

/// What the largest request or answer of a run takes, with room for the words of an error.
std::size_t bytes_for(const RuntimeRun& run) {
  Packer simulation, request;
  put_simulation(simulation, run.asset, run.recorded);
  put_run(request, run);
  const std::size_t rows = run.recorded.time_s.size() * run.channels,
                    columns = 1 + run.free.size() + (run.injected == nullptr ? 0 : run.injected->columns()),
                    asked = run.injected == nullptr ? 0 : run.injected->entries().size() + run.sites * kSiteSignals;
  constexpr std::size_t kWords = 1U << 16U;
  return std::max({simulation.used(), request.used(), rows * columns * sizeof(double), asked * sizeof(double)}) +
         kWords;
}

}  // namespace

Result<std::unique_ptr<RunProcess>> RunProcess::start(const std::string& fmu, const HostedPlant& plant,
                                                      std::size_t heap_bytes, const ProcessLimits& limits) {
  std::unique_ptr<RunProcess> process(new RunProcess(fmu, heap_bytes, limits));
  if (const Status launched = process->launch(); !launched) return fail(launched.error());
  Packer packer = process->packer();
  put_plant(packer, plant);
  const Status loaded = process->request(Operation::load_plant, "loading the plant", process->limits().start_s);
  if (!loaded) return fail(loaded.error());
  return process;
}

bool RunProcess::knows(std::uint64_t simulation) const {
  return std::ranges::find(known_, simulation, &Known::simulation) != known_.end();
}

Result<std::uint64_t> RunProcess::place_of_simulation(const RuntimeRun& run) {
  ++runs_;
  auto place = std::ranges::find(known_, run.simulation, &Known::simulation);
  if (place == known_.end()) {
    if (known_.size() < kMostSimulations) known_.emplace_back();
    place = std::ranges::min_element(known_, {}, &Known::used);
    *place = {};  // known again only once the process has it
    Packer packer = this->packer();
    packer.put(static_cast<std::uint64_t>(place - known_.begin()));
    put_simulation(packer, run.asset, run.recorded);
    const Status made = request(Operation::simulation, "the start of a simulation", limits().start_s);
    if (!made) return fail(made.error());
    place->simulation = run.simulation;
  }
  place->used = runs_;
  return static_cast<std::uint64_t>(place - known_.begin());
}

Result<SimulatedOutputs> RunProcess::run(const RuntimeRun& run) {
  const Result<std::uint64_t> place = place_of_simulation(run);
  if (!place) return fail(place.error());
  Packer packer = this->packer();
  packer.put(*place);
  put_run(packer, run);
  header().stop = 0;
  const auto look = [&] {
    if (passed(run.options.deadline)) header().stop = 1;
  };
  Status status = request(Operation::run, "a simulation", limits().call_s, kNoTime, look);
  std::vector<std::array<double, kSiteSignals>> signals(run.sites);
  while (status && header().status == AnswerStatus::asks) {
    Unpacker asked = unpacker();
    const auto time_s = asked.get<double>();
    for (auto& site : signals) std::ranges::copy(asked.numbers(kSiteSignals), site.begin());
    std::vector<double> weights(run.injected == nullptr ? 0 : run.injected->entries().size(), 0.0);
    if (run.injected != nullptr) run.injected->weigh(time_s, signals, weights);
    Packer answer = this->packer();
    answer.put_numbers(weights);
    look();
    status = request(Operation::weights, "a simulation", limits().call_s, kNoTime, look);
  }
  if (!status) return fail(status.error());
  Unpacker answer = unpacker();
  return get_outputs(answer);
}

Result<std::unique_ptr<RunProcess>> HostedRuns::take(const RuntimeRun& run) {
  const std::size_t needed = bytes_for(run);
  std::vector<std::unique_ptr<RunProcess>> gone;  // they take a while to end, in which nobody should wait
  {
    const std::scoped_lock lock(mutex_);
    const auto fit = [&](const auto& process) { return process->alive() && process->room_bytes() >= needed; };
    std::move(std::stable_partition(idle_.begin(), idle_.end(), fit), idle_.end(), std::back_inserter(gone));
    std::erase(idle_, nullptr);
    auto chosen = std::ranges::find_if(idle_, [&](const auto& process) { return process->knows(run.simulation); });
    if (chosen == idle_.end() && !idle_.empty()) chosen = idle_.begin();
    if (chosen != idle_.end()) {
      std::unique_ptr<RunProcess> process = std::move(*chosen);
      idle_.erase(chosen);
      return process;
    }
  }
  // Memory that is not touched costs nothing: the next runs may be larger.
  constexpr std::size_t kUsual = 64U << 20U;
  return RunProcess::start(fmu_, plant_, std::max(kUsual, 2 * needed), limits_);
}

Result<SimulatedOutputs> HostedRuns::run(const RuntimeRun& run) {
  if (const auto why_none = lost_.given_up()) return fail(*why_none);
  if (passed(run.options.deadline)) return fail("the simulation was ended: its time was up");
  auto process = take(run);
  if (!process) return fail(process.error());
  (*process)->keep(run.options.deadline);
  Result<SimulatedOutputs> outputs = (*process)->run(run);
  (*process)->keep(nullptr);
  lost_.note(**process);
  if (!(*process)->alive()) return outputs;
  const std::scoped_lock lock(mutex_);
  idle_.push_back(std::move(*process));
  return outputs;
}

}  // namespace sealwatch::fmi
