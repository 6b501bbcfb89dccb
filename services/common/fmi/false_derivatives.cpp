// Directional derivatives that hold at the start of a unit (check_derivatives()) may be wrong where a run goes.
//
//   (z(x + h d) - z(x)) / h  against  dz/dx d      d: the usual sizes of all states
//
// on the running instance, with steps h to both sides and of two widths. Where these four slopes differ from each other
// there is a corner, or values are rounded: then nothing is known of that point.
#include <algorithm>
#include <bit>
#include <cmath>

#include "services/common/fmi/fmu_evaluator.hpp"

namespace sealwatch::fmi {

bool RunningBlock::derivatives_hold(double time_s) {
  constexpr std::uint64_t kEnough = 3;  // a corner can lie at one point, not at three in a row
  if (block_.setup.state_directional == 0 || states_.empty()) return true;
  ++times_differentiated_;
  if (times_false_ == 0 && !std::has_single_bit(times_differentiated_)) return true;
  const std::optional<std::size_t> row = false_row(time_s);
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

std::optional<std::vector<double>> RunningBlock::z_beside(double time_s, double share) {
  std::vector<double> states = states_;
  for (std::size_t k = 0; k < states.size(); ++k)
    states[k] += share * block_.state_sizes[k] / std::abs(block_.states[k].factor);
  const auto values = processes_[0]->evaluate(time_s, states, inputs_, {});
  if (!values) return std::nullopt;
  return z_of(*values);
}

std::optional<std::size_t> RunningBlock::false_row(double time_s) {
  constexpr double kTolerance = 0.02;  // of what the single states do: the curvature over the wider steps is less
  constexpr double kAgree = 0.1;       // of what is wrong: the slopes among each other
  std::vector<std::vector<double>> slopes;
  for (const double share : {1e-6, -1e-6, 1e-4, -1e-4}) {
    std::optional<std::vector<double>> z = z_beside(time_s, share);
    if (!z) return std::nullopt;
    for (std::size_t row = 0; row < z->size(); ++row) (*z)[row] = ((*z)[row] - values_.z[row]) / share;
    slopes.push_back(std::move(*z));
  }
  for (std::size_t row = 0; row < values_.z.size(); ++row) {
    double said = 0.0, size = 0.0, low = slopes[0][row], high = low;
    for (std::size_t k = 0; k < states_.size(); ++k) {
      const double one = values_.by_state.row(row)[k] * block_.state_sizes[k];
      said += one, size += std::abs(one);
    }
    for (const auto& slope : slopes) low = std::min(low, slope[row]), high = std::max(high, slope[row]);
    const double apart = std::abs(said - 0.5 * (low + high));
    if (apart > kTolerance * std::max(size, std::abs(high)) && high - low < kAgree * apart) return row;
  }
  return std::nullopt;
}

}  // namespace sealwatch::fmi
