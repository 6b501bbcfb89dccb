// Directional derivatives that hold at the start of a unit (check_derivatives()) may be wrong where a run goes.
//
//   (z(x + h d_k) - z(x)) / h  against  dz/dx d_k      d_k: the usual size of state k alone; where asked for, of an input
//
// on the running instance, one after another, so that none hides behind others. Where one differs, with steps h to both
// sides and of two widths: where these four slopes differ from each other there is a corner, or values are rounded, and
// nothing is known of that point.
#include <algorithm>
#include <cmath>
#include <span>

#include "services/common/fmi/fmu_evaluator.hpp"

namespace sealwatch::fmi {

bool RunningBlock::derivatives_hold(double time_s, const EvaluationRequest& asked) {
  constexpr std::uint64_t kEnough = 3;  // a corner can lie at one point, not at three in a row
  if (states_.empty() || (asked.by_state == 0 && asked.by_input == 0)) return true;
  if (asked.by_state != 0 && !block_.setup.dependencies.empty() && !groups_hold(time_s) &&
      !differentiate_one_by_one(time_s, asked))
    return false;
  if (block_.setup.state_directional == 0) return true;
  if (times_differentiated_++ < next_look_ && times_false_by_state_ + times_false_by_input_ == 0) return true;
  // No more evaluations than the run has of its own, and ever fewer.
  const std::uint64_t columns = (asked.by_state != 0 ? states_.size() : 0) + (asked.by_input != 0 ? inputs_.size() : 0);
  next_look_ = times_differentiated_ + std::max(times_differentiated_ / 8, columns);
  // A point that asks for none of a kind tells nothing of it.
  const auto holds = [&](const BesidePoint& beside, const RuntimeMatrix& given, std::uint64_t& times_false) {
    const std::optional<std::size_t> row = false_row(time_s, beside, given);
    times_false = row ? times_false + 1 : 0;
    if (times_false < kEnough) return true;
    const std::size_t states = states_.size();
    const ModelDescription& description = block_.file->description();
    const std::string of = *row < states
                               ? description.name_of(description.derivatives[*row])
                               : element_of(description, block_.setup.outputs, block_.variables[*row - states].place);
    trouble_ = false_derivatives(*block_.file, "those of " + of + " at " + std::to_string(time_s) + " s").describe();
    return false;
  };
  if (asked.by_state != 0 && !holds({true, block_.state_sizes}, values_.by_state, times_false_by_state_)) return false;
  return asked.by_input == 0 || holds(beside_inputs(), values_.by_input, times_false_by_input_);
}

// (z(x + h d) - z(x)) / h against dz/dx d, for one d with every state in it, in shares that differ: columns of one
// group that reach the same row do not cancel. A corner shows too, and costs no more than its columns one by one.
bool RunningBlock::groups_hold(double time_s) {
  constexpr double kShare = 1e-6, kTolerance = 1e-4;
  std::vector<double> states = states_, along;
  for (std::size_t k = 0; k < states.size(); ++k) {
    constexpr double kGolden = 0.6180339887498949;
    const double turns = kGolden * static_cast<double>(k + 1);
    along.push_back((0.25 + turns - std::floor(turns)) * block_.state_sizes[k]);
    states[k] += kShare * along[k] / block_.states[k].factor;
  }
  const auto values = processes_[0]->evaluate(time_s, states, inputs_, {});
  if (!values) return true;  // the run itself goes on from here
  const std::vector<double> z = z_of(*values);
  for (std::size_t row = 0; row < z.size(); ++row) {
    const double* given = values_.by_state.row(row);
    double said = 0.0, together = 0.0;
    for (std::size_t k = 0; k < along.size(); ++k)
      said += given[k] * along[k], together += std::abs(given[k] * along[k]);
    const double shown = (z[row] - values_.z[row]) / kShare;
    constexpr double kRounding = 1e-13;  // of a value
    if (std::abs(shown - said) >
        kTolerance * std::max(together, std::abs(shown)) + kRounding * std::abs(values_.z[row]) / kShare)
      return false;
  }
  return true;
}

bool RunningBlock::differentiate_one_by_one(double time_s, EvaluationRequest asked) {
  asked.by_state = kOneByOne;
  const auto values = processes_[0]->evaluate(time_s, states_, inputs_, asked);
  if (!values) return trouble_ = values.error().describe(), false;
  convert(*values, asked);
  return true;
}

BesidePoint RunningBlock::beside_inputs() const {
  BesidePoint beside{false, {}};
  const std::size_t continuous = elements(std::span(block_.setup.inputs).first(block_.setup.continuous_inputs));
  for (const Port& input : block_.inputs) {  // those that are not continuous change at events only
    const double size = std::abs(input.unit.factor) * std::max(1.0, std::abs(inputs_[input.place]));
    beside.sizes.push_back(input.place < continuous ? size : 0.0);
  }
  return beside;
}

std::optional<std::vector<double>> RunningBlock::slope_along(double time_s, const BesidePoint& beside,
                                                             std::size_t column, double share) {
  std::vector<double> states = states_, inputs = inputs_;
  if (beside.of_states)
    states[column] += share * beside.sizes[column] / block_.states[column].factor;
  else
    inputs[block_.inputs[column].place] += share * beside.sizes[column] / block_.inputs[column].unit.factor;
  const auto values = processes_[0]->evaluate(time_s, states, inputs, {});
  if (!values) return std::nullopt;
  std::vector<double> z = z_of(*values);
  for (std::size_t row = 0; row < z.size(); ++row) z[row] = (z[row] - values_.z[row]) / share;
  return z;
}

std::optional<std::size_t> RunningBlock::false_row(double time_s, const BesidePoint& beside,
                                                   const RuntimeMatrix& given) {
  constexpr double kTolerance = 0.02;  // the curvature over the wider steps is less
  constexpr double kNothing = 1e-3;    // of what all do together
  constexpr double kAgree = 0.1;       // of what is wrong: the slopes among each other
  std::vector<double> together(values_.z.size());
  for (std::size_t row = 0; row < together.size(); ++row)
    for (std::size_t k = 0; k < beside.sizes.size(); ++k)
      together[row] += std::abs(given.row(row)[k] * beside.sizes[k]);
  for (std::size_t column = 0; column < beside.sizes.size(); ++column) {
    if (beside.sizes[column] == 0.0) continue;
    std::vector<std::vector<double>> slopes;
    const auto look = [&](double share) {
      auto slope = slope_along(time_s, beside, column, share);
      if (slope) slopes.push_back(std::move(*slope));
      return slope.has_value();
    };
    const auto is_false = [&](std::size_t row) {
      double low = slopes[0][row], high = low;
      for (const auto& slope : slopes) low = std::min(low, slope[row]), high = std::max(high, slope[row]);
      const double said = given.row(row)[column] * beside.sizes[column], apart = std::abs(said - 0.5 * (low + high));
      const double size = std::max({std::abs(said), std::abs(low), std::abs(high), kNothing * together[row]});
      return apart > kTolerance * size && high - low < kAgree * apart;
    };
    if (!look(1e-6)) return std::nullopt;
    for (std::size_t row = 0; row < together.size(); ++row) {
      if (!is_false(row)) continue;
      if (slopes.size() == 1)
        for (const double share : {-1e-6, 1e-4, -1e-4})
          if (!look(share)) return std::nullopt;
      if (is_false(row)) return row;
    }
  }
  return std::nullopt;
}

}  // namespace sealwatch::fmi
