#include "services/common/fmi/derivative_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace sealwatch::fmi {
namespace {

Partials kept(const Evaluation& values) {
  const auto copy = [](std::span<const double> numbers) { return std::vector<double>(numbers.begin(), numbers.end()); };
  return {copy(values.derivatives),          copy(values.outputs),
          copy(values.derivatives_by_state), copy(values.outputs_by_state),
          copy(values.derivatives_by_input), copy(values.outputs_by_input)};
}

}  // namespace

DerivativePoints::DerivativePoints(const FmuBlock& block) : block_(block) {
  for (std::size_t k = 0; k < block.states.size(); ++k)
    state_steps_.push_back(1e-7 * block.state_sizes[k] / std::abs(block.states[k].factor));
  for (const double size : block.input_sizes) input_steps_.push_back(1e-7 * size);
}

Result<std::vector<Partials>> DerivativePoints::evaluate(FmuProcess& process, double wider,
                                                         std::span<const double> parameters,
                                                         const EvaluationRequest& wanted) {
  std::vector<double> state_steps = state_steps_, input_steps = input_steps_;
  for (auto* steps : {&state_steps, &input_steps})
    for (double& step : *steps) step *= wider;
  const auto begun = process.begin({.start_time_s = block_.start_time_s,
                                    .stop_time_s = block_.stop_time_s,
                                    .state_steps = state_steps,
                                    .input_steps = input_steps,
                                    .inputs = block_.input_start,
                                    .slots = 1,
                                    .parameters = parameters});
  if (!begun) return fail(begun.error());
  if (points_.empty()) choose(begun->states);
  std::vector<Partials> partials;
  for (const DerivativePoint& point : points_) {
    const auto values = process.evaluate(block_.start_time_s, point.states, point.inputs, wanted);
    if (!values) return std::vector<Partials>();
    partials.push_back(kept(*values));
  }
  return partials;
}

// At the start many terms vanish; beside it they show. A corner where an input starts lies at one point at most.
void DerivativePoints::choose(const std::vector<double>& start) {
  constexpr std::array kAway = {0.013, -0.017, 0.029};
  for (const double away : kAway) {
    DerivativePoint point{start, block_.input_start};
    for (std::size_t k = 0; k < start.size(); ++k)
      point.states[k] += away * (1.0 + 0.1 * static_cast<double>(k)) * block_.state_sizes[k] / block_.states[k].factor;
    for (std::size_t k = 0; k < block_.setup.continuous_inputs; ++k)
      point.inputs[k] += 0.1 * away * std::max(block_.input_sizes[k], std::abs(point.inputs[k]));
    points_.push_back(std::move(point));
  }
}

}  // namespace sealwatch::fmi
