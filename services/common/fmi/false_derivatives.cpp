// Directional derivatives that hold at the start of a unit (check_derivatives()) may be wrong where a run goes.
//
//   (z(x + h d) - z(x)) / h  against  dz/dx d      d: the usual sizes of all states; where asked for, of all inputs
//
// on the running instance, with steps h to both sides and of two widths. Where these four slopes differ from each other
// there is a corner, or values are rounded: then nothing is known of that point.
#include <algorithm>
#include <cmath>
#include <span>

#include "services/common/fmi/fmu_evaluator.hpp"

namespace sealwatch::fmi {

bool RunningBlock::derivatives_hold(double time_s, const EvaluationRequest& asked) {
  constexpr std::uint64_t kEnough = 3;  // a corner can lie at one point, not at three in a row
  if (block_.setup.state_directional == 0 || states_.empty() || (asked.by_state == 0 && asked.by_input == 0))
    return true;
  if (times_differentiated_++ < next_look_ && times_false_ == 0) return true;
  next_look_ = times_differentiated_ + times_differentiated_ / 4;
  std::optional<std::size_t> row;
  if (asked.by_state != 0) row = false_row(time_s, {true, block_.state_sizes}, values_.by_state);
  if (!row && asked.by_input != 0) {
    BesidePoint beside{false, {}};
    const std::size_t continuous = elements(std::span(block_.setup.inputs).first(block_.setup.continuous_inputs));
    for (const Port& input : block_.inputs) {  // those that are not continuous change at events only
      const double size = std::abs(input.unit.factor) * std::max(1.0, std::abs(inputs_[input.place]));
      beside.way.push_back(input.place < continuous ? size : 0.0);
    }
    row = false_row(time_s, beside, values_.by_input);
  }
  times_false_ = row ? times_false_ + 1 : 0;
  if (times_false_ < kEnough) return true;
  const std::size_t states = states_.size();
  const ModelDescription& description = block_.file->description();
  const std::string of = *row < states
                             ? description.name_of(description.derivatives[*row])
                             : element_of(description, block_.setup.outputs, block_.variables[*row - states].place);
  trouble_ = false_derivatives(*block_.file, "those of " + of + " at " + std::to_string(time_s) + " s").describe();
  return false;
}

std::optional<std::vector<double>> RunningBlock::z_beside(double time_s, const BesidePoint& beside, double share) {
  std::vector<double> states = states_, inputs = inputs_;
  for (std::size_t k = 0; k < beside.way.size(); ++k)
    if (beside.of_states)
      states[k] += share * beside.way[k] / block_.states[k].factor;
    else
      inputs[block_.inputs[k].place] += share * beside.way[k] / block_.inputs[k].unit.factor;
  const auto values = processes_[0]->evaluate(time_s, states, inputs, {});
  if (!values) return std::nullopt;
  return z_of(*values);
}

std::optional<std::size_t> RunningBlock::false_row(double time_s, const BesidePoint& beside,
                                                   const RuntimeMatrix& given) {
  constexpr double kTolerance = 0.02;  // of what the single ones do: the curvature over the wider steps is less
  constexpr double kAgree = 0.1;       // of what is wrong: the slopes among each other
  std::vector<std::vector<double>> slopes;
  for (const double share : {1e-6, -1e-6, 1e-4, -1e-4}) {
    std::optional<std::vector<double>> z = z_beside(time_s, beside, share);
    if (!z) return std::nullopt;
    for (std::size_t row = 0; row < z->size(); ++row) (*z)[row] = ((*z)[row] - values_.z[row]) / share;
    slopes.push_back(std::move(*z));
  }
  for (std::size_t row = 0; row < values_.z.size(); ++row) {
    double said = 0.0, size = 0.0, low = slopes[0][row], high = low;
    for (std::size_t k = 0; k < beside.way.size(); ++k) {
      const double one = given.row(row)[k] * beside.way[k];
      said += one, size += std::abs(one);
    }
    for (const auto& slope : slopes) low = std::min(low, slope[row]), high = std::max(high, slope[row]);
    const double apart = std::abs(said - 0.5 * (low + high));
    if (apart > kTolerance * std::max(size, std::abs(high)) && high - low < kAgree * apart) return row;
  }
  return std::nullopt;
}

}  // namespace sealwatch::fmi
