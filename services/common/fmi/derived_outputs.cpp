#include "services/common/fmi/derived_outputs.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "services/common/fmi/derivative_points.hpp"

namespace sealwatch::fmi {
namespace {

/// What one state, input or parameter does over its usual size to derivatives and variables, in the FMU's units: one
/// row for each point.
struct Influence {
  std::vector<std::vector<double>> on_derivatives, on_outputs;
  std::vector<std::vector<double>> derivatives = {};  ///< themselves, of a parameter
};

/// c, and whether parameters change it; c is 0 where an output does not follow the derivative.
struct Following {
  double factor = 0.0;
  bool scaled = false;
};

class DerivedOutputs {
 public:
  DerivedOutputs(const FmuBlock& block, FmuProcess& process) : block_(block), process_(process), points_(block) {}

  Status look_at_states_and_inputs() {
    const auto partials = points_.partials(process_, 1.0);
    if (!partials) return fail(partials.error());
    const std::size_t states = block_.states.size();
    for (std::size_t k = 0; k < states && !partials->empty(); ++k) {
      const double size = block_.state_sizes[k] / std::abs(block_.states[k].factor);
      add(*partials, &Partials::derivatives_by_state, &Partials::outputs_by_state, k, states, size);
    }
    const std::size_t inputs = elements(std::span(block_.setup.inputs).first(block_.setup.continuous_inputs));
    for (std::size_t k = 0; k < inputs && !partials->empty(); ++k)
      add(*partials, &Partials::derivatives_by_input, &Partials::outputs_by_input, k, inputs, block_.input_sizes[k]);
    return {};
  }

  // A unit may refuse a value: then that parameter tells nothing.
  void look_at_parameters() {
    constexpr double kStep = 1e-3;  // of a value: rounding and curvature are both far below what is looked for
    for (const Port& port : block_.parameters) {
      std::vector<double> above = block_.parameter_start, below = above;
      const double step = kStep * std::abs(above[port.place]);
      above[port.place] += step, below[port.place] -= step;
      if (step == 0.0) continue;
      const auto upper = points_.values(process_, above), lower = points_.values(process_, below);
      if (!process_.alive()) return;
      if (!upper || !lower || upper->empty() || lower->empty()) continue;
      Influence& one = influences_.emplace_back();
      const auto differences = [](const std::vector<double>& a, const std::vector<double>& b) {
        std::vector<double> result;
        for (std::size_t k = 0; k < a.size(); ++k) result.push_back((a[k] - b[k]) / (2.0 * kStep));
        return result;
      };
      for (std::size_t k = 0; k < upper->size(); ++k) {
        one.on_derivatives.push_back(differences((*upper)[k].derivatives, (*lower)[k].derivatives));
        one.on_outputs.push_back(differences((*upper)[k].outputs, (*lower)[k].outputs));
        one.derivatives.push_back((*upper)[k].derivatives);
      }
    }
  }

  /// Of an element of the outputs.
  [[nodiscard]] Following following(std::size_t state, std::size_t output, std::size_t least_influences) const {
    constexpr double kNothing = 1e-4;  // of the largest
    double largest = 0.0, products = 0.0, squares = 0.0;
    for (const Influence& one : influences_)
      for (const auto& rates : one.on_derivatives) largest = std::max(largest, std::abs(rates[state]));
    const auto moves = [&](const Influence& one, std::size_t point) {
      return std::abs(one.on_derivatives[point][state]) > kNothing * largest;
    };
    for (const Influence& one : influences_)
      for (std::size_t point = 0; one.derivatives.empty() && point < one.on_outputs.size(); ++point) {
        if (!moves(one, point)) continue;
        const double rate = one.on_derivatives[point][state];
        products += rate * one.on_outputs[point][output], squares += rate * rate;
      }
    const double c = products / squares;
    if (!(squares > 0.0) || !std::isfinite(c) || c == 0.0) return {};
    Following result{.factor = c};
    std::size_t moving = 0;
    for (const Influence& one : influences_) {
      bool any = false, follows = true;
      for (std::size_t point = 0; point < one.on_outputs.size(); ++point) {
        if (!moves(one, point)) continue;
        any = true;
        follows = follows && is_same(one.on_outputs[point][output], c * one.on_derivatives[point][state]);
      }
      if (!any) continue;
      if (!follows && !scales(one, state, output, c)) return {};
      moving += follows ? 1 : 0;
      result.scaled = result.scaled || !follows;
    }
    return moving >= least_influences ? result : Following();
  }

 private:
  static bool is_same(double value, double expected) {
    constexpr double kTolerance = 1e-3;  // of an influence
    return std::abs(value - expected) <= kTolerance * std::abs(expected);
  }

  /// Whether what the parameter does beside c df is dc f, with one dc at all points.
  static bool scales(const Influence& one, std::size_t state, std::size_t output, double c) {
    std::optional<double> dc;
    for (std::size_t point = 0; point < one.derivatives.size(); ++point) {
      const double beside = one.on_outputs[point][output] - c * one.on_derivatives[point][state];
      const double rate = one.derivatives[point][state];
      if (dc ? !is_same(beside, *dc * rate) : rate == 0.0) return false;
      if (!dc) dc = beside / rate;
    }
    return dc.has_value();
  }

  void add(const std::vector<Partials>& partials, std::vector<double> Partials::*of_derivatives,
           std::vector<double> Partials::*of_outputs, std::size_t column, std::size_t columns, double size) {
    Influence& one = influences_.emplace_back();
    const auto column_of = [&](const std::vector<double>& matrix) {
      std::vector<double> result;
      for (std::size_t k = column; k < matrix.size(); k += columns) result.push_back(size * matrix[k]);
      return result;
    };
    for (const Partials& at : partials) {
      one.on_derivatives.push_back(column_of(at.*of_derivatives));
      one.on_outputs.push_back(column_of(at.*of_outputs));
    }
  }

  const FmuBlock& block_;
  FmuProcess& process_;
  DerivativePoints points_;
  std::vector<Influence> influences_;
};

}  // namespace

Result<std::vector<DerivedOutput>> outputs_of_derivatives(const FmuBlock& block, std::span<const std::size_t> variables,
                                                          std::span<const std::size_t> states) {
  std::vector<DerivedOutput> found;
  auto process = FmuProcess::start(block.file->name(), block.setup, 1);
  if (!process) return fail(process.error());
  DerivedOutputs derived(block, **process);
  if (const Status begun = derived.look_at_states_and_inputs(); !begun) return fail(begun.error());
  for (const std::size_t state : states)
    for (const std::size_t variable : variables)
      if (derived.following(state, block.variables[variable].place, 1).factor != 0.0)
        found.push_back({variable, state});
  if (found.empty()) return found;  // as nearly always: then parameters, each a start of its own, are not looked at
  derived.look_at_parameters();
  std::erase_if(found, [&](DerivedOutput& one) {
    const Port& port = block.variables[one.variable];
    const Following following = derived.following(one.state, port.place, 2);
    one.factor = following.factor * port.unit.factor / block.states[one.state].factor;
    one.scaled = following.scaled;
    return one.factor == 0.0;
  });
  return found;
}

}  // namespace sealwatch::fmi
