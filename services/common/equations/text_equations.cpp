#include "services/common/equations/text_equations.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "services/common/equations/tape.hpp"
#include "services/common/model/first_value.hpp"

namespace sealwatch::equations {
namespace {

/// One function with the derivatives asked for, compiled: its tape and where each result goes.
class Program {
 public:
  Program(const TextEquationsParts& parts, const FunctionNodes& nodes, RuntimeDirections directions,
          std::span<const std::size_t> parameters, std::span<const double> values)
      : places_(parts.places),
        used_inputs_(parts.used_inputs),
        directions_(directions),
        tape_(compile(parts, nodes, directions, parameters)) {
    registers_ = tape_.registers();
    std::ranges::copy(values, registers_.begin() + static_cast<std::ptrdiff_t>(places_.parameters));
    tape_.prepare(registers_);
  }

  [[nodiscard]] RuntimeDirections directions() const { return directions_; }

  const RuntimeLinearisation& run(const RuntimePoint& at) {
    registers_[0] = at.time_s;
    fill(places_.states, at.states);
    for (std::size_t k = 0; k < used_inputs_.size(); ++k) {
      registers_[places_.inputs + used_inputs_[k]] = at.inputs[k];
      registers_[places_.rates + used_inputs_[k]] = at.input_rates[k];
    }
    fill(places_.added, at.added);
    tape_.run(registers_);
    for (std::size_t k = 0; k < targets_.size(); ++k) *targets_[k] = tape_.result(registers_, k);
    return result_;
  }

 private:
  void fill(std::size_t first, std::span<const double> values) {
    std::ranges::copy(values, registers_.begin() + static_cast<std::ptrdiff_t>(first));
  }

  // Entries that are always zero are neither computed nor written.
  void add(const Expressions& expressions, Node node, double* target, std::vector<Node>& nodes) {
    if (expressions.is_constant(node, 0.0)) return;
    nodes.push_back(node);
    targets_.push_back(target);
  }

  Tape compile(const TextEquationsParts& parts, const FunctionNodes& nodes, RuntimeDirections directions,
               std::span<const std::size_t> parameters) {
    const std::size_t rows = nodes.values.size();
    result_.values.assign(rows, 0.0);
    result_.by_state.resize(rows, places_.inputs - places_.states);
    result_.by_parameter.resize(rows, parameters.size());
    result_.by_added.resize(rows, places_.count - places_.added);
    std::vector<Node> wanted;
    const Expressions& e = parts.expressions;
    for (std::size_t row = 0; row < rows; ++row) {
      add(e, nodes.values[row], &result_.values[row], wanted);
      for (std::size_t k = 0; directions.states && k < nodes.by_state[row].size(); ++k)
        add(e, nodes.by_state[row][k], result_.by_state.row(row) + k, wanted);
      for (std::size_t k = 0; directions.parameters && k < parameters.size(); ++k)
        add(e, nodes.by_parameter[row][parameters[k]], result_.by_parameter.row(row) + k, wanted);
      for (std::size_t k = 0; directions.added && k < nodes.by_added[row].size(); ++k)
        add(e, nodes.by_added[row][k], result_.by_added.row(row) + k, wanted);
    }
    std::vector<bool> fixed(places_.count, false);
    std::fill(fixed.begin() + static_cast<std::ptrdiff_t>(places_.parameters),
              fixed.begin() + static_cast<std::ptrdiff_t>(places_.added), true);
    return {e, wanted, fixed};
  }

  VariablePlaces places_;
  const std::vector<std::size_t>& used_inputs_;
  RuntimeDirections directions_;
  RuntimeLinearisation result_;
  std::vector<double*> targets_;
  Tape tape_;
  std::vector<double> registers_;
};

class TextEvaluator final : public RuntimeEvaluator {
 public:
  TextEvaluator(const TextEquationsParts& parts, std::span<const double> values,
                std::span<const std::size_t> differentiated_by)
      : parts_(parts),
        values_(values.begin(), values.end()),
        differentiated_by_(differentiated_by.begin(), differentiated_by.end()) {}

  bool evaluate(RuntimeFunction function, const RuntimePoint& at, std::span<double> values) override {
    const RuntimeLinearisation& result = program(function, {}).run(at);
    std::ranges::copy(result.values, values.begin());
    return true;
  }

  const RuntimeLinearisation* linearise(RuntimeFunction function, const RuntimePoint& at,
                                        RuntimeDirections directions) override {
    return &program(function, directions).run(at);
  }

 private:
  Program& program(RuntimeFunction function, RuntimeDirections directions) {
    auto& programs = programs_[static_cast<std::size_t>(function)];
    for (const auto& known : programs)
      if (known->directions() == directions) return *known;
    const std::array nodes = {&parts_.derivatives, &parts_.signals, &parts_.outputs};
    programs.push_back(std::make_unique<Program>(parts_, *nodes[static_cast<std::size_t>(function)], directions,
                                                 differentiated_by_, values_));
    return *programs.back();
  }

  const TextEquationsParts& parts_;
  std::vector<double> values_;
  std::vector<std::size_t> differentiated_by_;
  std::array<std::vector<std::unique_ptr<Program>>, 3> programs_;
};

/// First value, slope over the first ten samples, mean.
std::array<double, 3> statistics(const TimeSeries& recorded, const Series& series) {
  constexpr std::size_t kSlope = 10;
  const std::vector<double>& values = series.values;
  std::array<double, 3> result{*first_value(recorded, series.name)};
  const std::size_t last = std::min(kSlope, values.size() - 1);
  const double duration = recorded.time_s[last] - recorded.time_s[0];
  result[1] = duration > 0.0 ? (values[last] - values[0]) / duration : 0.0;
  for (const double value : values) result[2] += value / static_cast<double>(values.size());
  return result;
}

}  // namespace

FunctionNodes differentiated(Expressions& expressions, std::vector<Node> values, const VariablePlaces& places) {
  FunctionNodes nodes{.values = std::move(values), .by_state = {}, .by_parameter = {}, .by_added = {}};
  const auto gradient = [&](Node of, std::size_t first, std::size_t end) {
    std::vector<Node> row;
    for (std::size_t k = first; k < end; ++k) row.push_back(expressions.derivative(of, k));
    return row;
  };
  for (const Node of : nodes.values) {
    nodes.by_state.push_back(gradient(of, places.states, places.inputs));
    nodes.by_parameter.push_back(gradient(of, places.parameters, places.added));
    nodes.by_added.push_back(gradient(of, places.added, places.count));
  }
  return nodes;
}

Result<std::unique_ptr<RuntimeEvaluator>> TextEquations::evaluator(
    const RuntimePoint& first, std::span<const std::size_t> differentiated_by) const {
  return std::make_unique<TextEvaluator>(parts_, first.parameters, differentiated_by);
}

Result<std::vector<double>> TextEquations::initial_state(std::span<const double> parameters,
                                                         const TimeSeries& recorded) const {
  const StartNodes& start = parts_.start;
  const std::size_t count = start.parameters + 3 * start.channels.size();
  std::vector<double> state;
  for (const StartOfState& of : start.states) {
    const auto recorded_all = [&](const StartOfState::Choice& choice) {
      return std::ranges::all_of(choice.channels, [&](const std::string& name) {
        const Series* series = recorded.find(name);
        return series != nullptr && !series->values.empty();
      });
    };
    const auto choice = std::ranges::find_if(of.choices, recorded_all);
    if (choice == of.choices.end())
      return fail(Error{.file = {},
                        .place = "start of state " + of.state,
                        .value = of.choices.back().channels.front(),
                        .rule = "is not recorded",
                        .advice = "add a column with it, or give the state a second start: start: [CHANNEL, VALUE]"});
    const std::array<Node, 1> wanted = {choice->node};
    const Tape tape(start.expressions, wanted, std::vector<bool>(count, false));
    std::vector<double> registers = tape.registers();
    std::ranges::copy(parameters, registers.begin());
    for (std::size_t c = 0; c < start.channels.size(); ++c)
      if (const Series* series = recorded.find(start.channels[c]); series != nullptr && !series->values.empty())
        std::ranges::copy(statistics(recorded, *series),
                          registers.begin() + static_cast<std::ptrdiff_t>(start.parameters + 3 * c));
    tape.run(registers);
    const double value = tape.result(registers, 0);
    if (!std::isfinite(value)) return fail("the start of state " + of.state + " is not a finite number");
    state.push_back(value);
  }
  return state;
}

}  // namespace sealwatch::equations
