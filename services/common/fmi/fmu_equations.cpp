#include "services/common/fmi/fmu_equations.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/fmi/fmu_evaluator.hpp"

namespace sealwatch::fmi {

FmuEquations::FmuEquations(FmuBlock block, std::shared_ptr<const RuntimeEquations> frame, Counts counts,
                           bool outputs_see_added)
    : block_(std::move(block)),
      frame_(std::move(frame)),
      counts_(counts),
      outputs_see_added_(outputs_see_added),
      runs_(std::make_unique<HostedRuns>(block_.file->name(), block_.plant)) {}

// Instances of a run stand side by side in one process, which not every binary allows.
bool FmuEquations::runs_elsewhere() const {
  return !block_.plant.file.empty() && block_.setup.once_per_process == 0 && !local_hosts();
}

Result<std::unique_ptr<RuntimeEvaluator>> FmuEquations::evaluator(const RuntimePoint& first,
                                                                  std::span<const std::size_t> differentiated) const {
  auto frame = frame_->evaluator(first, differentiated);
  if (!frame) return fail(frame.error());
  const std::vector<double> added(block_.states.size() + block_.variables.size() + counts_.sites, 0.0);
  RuntimePoint inner = first;
  inner.added = added;
  const RuntimeLinearisation* at =
      (*frame)->linearise(RuntimeFunction::outputs, inner, {.states = false, .parameters = true, .added = false});
  if (at == nullptr) return fail("the FMU's inputs and parameters have no values", (*frame)->trouble());
  // Relative to the parameter: one-sided differences then err by some 1e-6 of themselves.
  constexpr double kStep = 1e-6;
  std::vector<double> steps;
  std::vector<BlockStart> starts{start_of(*at, 0, 0.0)};
  for (std::size_t k = 0; k < differentiated.size(); ++k) {
    const double size = std::abs(first.parameters[differentiated[k]]);
    steps.push_back(kStep * (size > 0.0 ? size : 1.0));
    starts.push_back(start_of(*at, k, steps.back()));
  }
  auto running = RunningBlock::begin(block_, pool_, first.time_s, starts, std::move(steps));
  if (!running) return fail(running.error());
  return std::make_unique<FmuEvaluator>(block_, std::move(*frame), std::move(*running), counts_.outputs, counts_.sites,
                                        differentiated.size(), frame_->signals_see_added());
}

BlockStart FmuEquations::start_of(const RuntimeLinearisation& at, std::size_t direction, double step) const {
  BlockStart start;
  const auto put = [&](std::size_t row, std::vector<double>& values) {
    values.push_back(at.values[row]);
    if (step != 0.0) values.back() += step * at.by_parameter.row(row)[direction];
  };
  const std::size_t inputs = block_.inputs.size();
  for (std::size_t k = 0; k < inputs; ++k) put(counts_.outputs + k, start.inputs);
  for (std::size_t k = 0; k < block_.parameters.size(); ++k) put(counts_.outputs + inputs + k, start.parameters);
  return start;
}

namespace {

constexpr const char* kDerivativeRule = "gives directional derivatives that are not the derivatives of its own values";

/// What is wrong with the derivatives at one point; "" where nothing is, nothing where the unit gives none. Differences
/// over two steps that differ from each other are no measure: there the model has a corner.
std::optional<std::string> fault_at(FmuProcess& honest, FmuProcess& claimed, const FmuBlock& block, double time_s,
                                    std::span<const double> states, std::span<const double> inputs) {
  const EvaluationRequest by_all{1, 1, 0};
  const auto shows = honest.evaluate(time_s, states, inputs, by_all);
  if (!shows) return shows.error().describe();
  const auto says = claimed.evaluate(time_s, states, inputs, by_all);
  if (!says) return std::nullopt;
  const std::size_t n = block.states.size();
  const std::span<const double> said = says->derivatives_by_state;
  constexpr double kTolerance = 1e-3;
  const ModelDescription& description = block.file->description();
  for (std::size_t row = 0; row < n; ++row) {
    double largest = 0.0;
    for (std::size_t column = 0; column < n; ++column)
      largest = std::max(largest, std::abs(shows->derivatives_by_state[row * n + column]));
    for (std::size_t column = 0; column < n; ++column) {
      const double a = said[row * n + column], b = shows->derivatives_by_state[row * n + column];
      if (!(std::abs(a - b) > kTolerance * std::max({std::abs(a), std::abs(b), 1e-3 * largest}) + 1e-9)) continue;
      return "d " + description.name_of(description.derivatives[row]) + " / d " +
             description.name_of(description.states[column]) + " is said to be " + std::to_string(a) +
             ", where its derivatives change by " + std::to_string(b);
    }
  }
  return "";
}

}  // namespace

Status check_derivatives(FmuBlock& block) {
  if (block.setup.co_simulation != 0 || block.setup.state_directional == 0 || block.states.empty()) return {};
  FmuBlock differences = block;
  differences.setup.state_directional = differences.setup.output_directional = 0;
  const auto pool = std::make_shared<ProcessPool>();
  std::vector<std::unique_ptr<FmuProcess>> both;
  Beginning beginning;
  for (const FmuBlock* one : {&std::as_const(differences), &std::as_const(block)}) {
    auto process = FmuProcess::start(block.file->name(), one->setup, 1);
    if (!process) return fail(process.error());
    std::vector<double> steps;
    for (std::size_t k = 0; k < block.states.size(); ++k)
      steps.push_back(1e-7 * block.state_sizes[k] / std::abs(block.states[k].factor));
    const std::vector<double> input_steps(block.input_start.size(), 1e-7);
    auto begun = (*process)->begin({.start_time_s = block.start_time_s,
                                    .state_steps = steps,
                                    .input_steps = input_steps,
                                    .inputs = block.input_start,
                                    .slots = 1,
                                    .parameters = block.parameter_start});
    if (!begun) return fail(begun.error());
    beginning = std::move(*begun);
    both.push_back(std::move(*process));
  }
  std::string fault;
  // At the start many terms vanish; beside it they show. A corner can lie at one point, not at all of them.
  int wrong = 0;
  constexpr std::array kAway = {0.013, -0.017, 0.029};
  for (const double away : kAway) {
    std::vector<double> states = beginning.states, inputs = block.input_start;
    for (std::size_t k = 0; k < states.size(); ++k)
      states[k] += away * (1.0 + 0.1 * static_cast<double>(k)) * block.state_sizes[k] / block.states[k].factor;
    const auto here = fault_at(*both[0], *both[1], block, block.start_time_s, states, inputs);
    if (!here) return block.setup.state_directional = block.setup.output_directional = 0, Status();
    if (here->empty()) continue;
    fault = *here;
    ++wrong;
  }
  if (wrong < static_cast<int>(kAway.size())) return {};
  return fail(Error{.file = block.file->name(),
                    .place = "directional derivatives",
                    .value = fault,
                    .rule = kDerivativeRule,
                    .advice = "tell its maker; an FMU exported without directional derivatives works"});
}

}  // namespace sealwatch::fmi
