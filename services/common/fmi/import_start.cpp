#include "services/common/fmi/import_start.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "services/common/fmi/fmu_plant.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::fmi {
namespace {

using Clock = std::chrono::steady_clock;

class UnitStart {
 public:
  UnitStart(const FmuFile& file, const ImportOptions& options, ImportRows& rows)
      : file_(file), fmu_(file.description()), options_(options), rows_(rows), trial_s_(options.trial_s) {}

  // The states' values and sizes are known to the running model alone, and so are starts that the description lacks.
  Result<ImportStart> run() {
    Selection selection = driven();
    const auto setup = file_.setup(selection);
    if (!setup) return fail(setup.error());
    std::vector<double> inputs = starts_of(selection.inputs);
    std::vector<double> parameters = starts_of(selection.parameters);
    auto process = FmuProcess::start(file_.name(), *setup, 1, {.start_s = options_.start_s});
    if (!process) return fail(process.error());
    const std::vector<double> steps(rows_.states.size(), 1e-7), input_steps(inputs.size(), 1e-7);
    const auto begin = [&] {
      return (*process)->begin({.start_time_s = fmu_.start_time_s.value_or(0.0),
                                .stop_time_s = fmu_.stop_time(),
                                .state_steps = steps,
                                .input_steps = input_steps,
                                .inputs = inputs,
                                .parameters = parameters});
    };
    const auto before = Clock::now();
    auto beginning = begin();
    if (!beginning) {
      const bool hung = (*process)->loss() && (*process)->loss()->hung;  // it has been waited for long enough
      return !hung && leave_out_refused(selection) ? run() : fail(beginning.error());
    }
    constexpr double kSlower = 3.0;  // than the first start
    trial_s_ = std::max(trial_s_, kSlower * std::chrono::duration<double>(Clock::now() - before).count());
    out_.beginning = std::move(*beginning);
    if (const Status read = read_starts(**process, selection.outputs, inputs); !read) return fail(read.error());
    out_.linked.assign(rows_.states.size(), false);
    for (std::size_t k = 0; k < rows_.states.size(); ++k) out_.linked[k] = is_linked(rows_.states[k].element.variable);
    leave_to_unit();
    if (rows_.states.empty()) return std::move(out_);
    std::vector<Movable> movable;
    add_movable(selection.inputs, inputs, movable);
    std::erase_if(movable,
                  [&](const Movable& one) { return !changes_between_events(fmu_.variables[one.of.variable]); });
    add_movable(selection.parameters, parameters, movable);
    (*process)->limit_start(trial_s_);
    try_changes(movable, begin, **process);
    find_shown_states();
    return std::move(out_);
  }

 private:
  // What drives the running model; what is read of it are starts that the description lacks.
  [[nodiscard]] Selection driven() const {
    Selection selection;
    for (const ImportRow& row : rows_.inputs)
      if (row.element.element == 0) selection.inputs.push_back(row.element.variable);
    for (const ImportRow& row : rows_.parameters)
      if (row.element.element == 0)
        (fmu_.variables[row.element.variable].start.empty() ? selection.outputs : selection.parameters)
            .push_back(row.element.variable);
    return selection;
  }

  // Some tools export parameters whose values their own binary refuses; it may not say which, or end. Whether there are
  // any, so that what is left starts.
  bool leave_out_refused(const Selection& selection) {
    if (selection.parameters.empty() || !starts_with(selection.inputs, {})) return false;
    trials_end_ =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options_.trials_s));
    std::set<std::size_t> refused;
    add_refused(selection.inputs, selection.parameters, refused);
    if (refused.empty()) return false;
    std::string names;
    for (const std::size_t variable : refused)
      if (names.size() < 200) text::add_to_list(names, fmu_.variables[variable].name);
    options_.tell("it does not start with values for " + text::count_of(refused.size(), "parameter") +
                  ", which it declares: " + names + (names.size() < 200 ? "" : ", ...") +
                  "; left out, so that it keeps its own");
    std::erase_if(rows_.parameters, [&](const ImportRow& row) { return refused.contains(row.element.variable); });
    return true;
  }

  // Halves of a list that does not start; when time is up, all of it.
  void add_refused(const std::vector<std::size_t>& inputs, std::span<const std::size_t> parameters,
                   std::set<std::size_t>& refused) {
    const bool late = Clock::now() > trials_end_;
    if (!late && starts_with(inputs, {parameters.begin(), parameters.end()})) return;
    if (late || parameters.size() == 1) return refused.insert(parameters.begin(), parameters.end()), void();
    const std::size_t half = parameters.size() / 2;
    add_refused(inputs, parameters.first(half), refused);
    add_refused(inputs, parameters.subspan(half), refused);
  }

  [[nodiscard]] bool starts_with(std::vector<std::size_t> inputs, std::vector<std::size_t> parameters) const {
    Selection selection;
    selection.inputs = std::move(inputs), selection.parameters = std::move(parameters);
    const auto setup = file_.setup(selection);
    if (!setup) return false;
    const auto process = FmuProcess::start(file_.name(), *setup, 1, {.start_s = trial_s_, .call_s = trial_s_});
    const std::vector<double> input_values = starts_of(selection.inputs), values = starts_of(selection.parameters);
    const std::vector<double> steps(rows_.states.size(), 1e-7), input_steps(input_values.size(), 1e-7);
    return process && (*process)
                          ->begin({.start_time_s = fmu_.start_time_s.value_or(0.0),
                                   .stop_time_s = fmu_.stop_time(),
                                   .state_steps = steps,
                                   .input_steps = input_steps,
                                   .inputs = input_values,
                                   .parameters = values})
                          .has_value();
  }

  [[nodiscard]] std::vector<double> starts_of(const std::vector<std::size_t>& variables) const {
    std::vector<double> values;
    for (const std::size_t variable : variables) {
      const Variable& of = fmu_.variables[variable];
      for (std::size_t k = 0; k < of.size; ++k) values.push_back(of.start.empty() ? 0.0 : of.start[k]);
    }
    return values;
  }

  // What is no number cannot be written, and is left to the unit.
  void leave_to_unit() {
    for (std::size_t k = 0; k < rows_.states.size(); ++k) {
      if (std::isfinite(out_.beginning.states[k])) continue;
      out_.linked[k] = true;
      options_.tell("the state " + fmu_.name_of(rows_.states[k].element) +
                    " starts at no finite number: the file leaves its start to the unit (start: fmu)");
    }
    std::set<std::size_t> without;
    for (const ImportRow& row : rows_.parameters)
      if (!std::isfinite(out_.of_parameter(fmu_, row.element)) && without.insert(row.element.variable).second)
        options_.tell("the parameter " + fmu_.variables[row.element.variable].name +
                      " has no finite value: it is left out, and the unit keeps its own");
    std::erase_if(rows_.parameters, [&](const ImportRow& row) { return without.contains(row.element.variable); });
  }

  // Outputs that have a state's value at the start, and beside it with other values of what it starts with: that state
  // may begin at the output's first sample. Elsewhere they may differ (a sensor that saturates), so that they stay
  // variables of their own. What fails here is no fault: then nothing is known of them.
  void find_shown_states() {
    Selection selection = driven();
    selection.outputs.clear();
    for (const ImportRow& row : rows_.outputs)
      if (row.element.element == 0 && !row.state && fmu_.variables[row.element.variable].type == FmiType::float64)
        selection.outputs.push_back(row.element.variable);
    const auto setup = file_.setup(selection);
    if (selection.outputs.empty() || !setup) return;
    if (setup->continuous_inputs < setup->inputs.size()) return;  // those that events alone change stay as they are
    auto process = FmuProcess::start(file_.name(), *setup, 1, {.start_s = trial_s_, .call_s = trial_s_});
    if (!process) return;
    std::vector<double> inputs = starts_of(selection.inputs), parameters = starts_of(selection.parameters);
    for (std::size_t k = 0; k < inputs.size() && others_start_; ++k) inputs[k] += beside(k, inputs[k]);
    for (std::size_t k = 0; k < parameters.size() && others_start_; ++k) parameters[k] += beside(k, parameters[k]);
    const std::vector<double> steps(rows_.states.size(), 1e-7), input_steps(inputs.size(), 1e-7);
    const double time_s = fmu_.start_time_s.value_or(0.0);
    const auto begun = (*process)->begin({.start_time_s = time_s,
                                          .stop_time_s = fmu_.stop_time(),
                                          .state_steps = steps,
                                          .input_steps = input_steps,
                                          .inputs = inputs,
                                          .parameters = parameters});
    if (!begun) return;
    std::vector<double> states = begun->states;
    for (std::size_t k = 0; k < states.size(); ++k) states[k] += 10.0 * beside(k, begun->nominals[k]);
    if (const auto there = (*process)->evaluate(time_s, states, inputs, {}))
      take_equal(selection.outputs, there->outputs, states);
  }

  void take_equal(const std::vector<std::size_t>& variables, std::span<const double> values,
                  const std::vector<double>& states) {
    constexpr double kRounding = 1e-12;
    for (const std::size_t variable : variables) {
      for (ImportRow& output : rows_.outputs) {
        if (output.element.variable != variable) continue;
        const double value = values[output.element.element];
        for (std::size_t k = 0; k < states.size() && !output.state; ++k)
          if (std::abs(value - states[k]) <= kRounding * std::abs(states[k]) && output.unit == rows_.states[k].unit &&
              output.scale.factor == rows_.states[k].scale.factor &&
              output.scale.offset == rows_.states[k].scale.offset)
            output.state = k;
      }
      values = values.subspan(fmu_.variables[variable].size);
    }
  }

  /// For each a way of its own.
  static double beside(std::size_t k, double value) {
    constexpr double kShare = 1e-3;
    return kShare * (1.0 + 0.01 * static_cast<double>(k % 50)) * (value == 0.0 ? 1.0 : value);
  }

  /// What may move a state at the start.
  struct Movable {
    Element of;
    double* value;
  };

  void add_movable(const std::vector<std::size_t>& variables, std::vector<double>& values,
                   std::vector<Movable>& movable) const {
    std::size_t place = 0;
    for (const std::size_t variable : variables)
      for (std::size_t k = 0; k < fmu_.variables[variable].size; ++k)
        movable.push_back({{variable, k}, &values[place++]});
  }

  // The description may not say which states parameters and inputs move at the start: all are changed at once, each by
  // another share, or one by one where the model does not start with all of them changed.
  template <class Begin>
  void try_changes(const std::vector<Movable>& movable, const Begin& begin, const FmuProcess& process) {
    if (movable.empty()) return;
    std::vector<double> before;
    for (const Movable& one : movable) before.push_back(*one.value);
    for (std::size_t k = 0; k < movable.size(); ++k) *movable[k].value += beside(k, before[k]);
    const auto all_moved = begin();
    for (std::size_t k = 0; k < movable.size(); ++k) *movable[k].value = before[k];
    if (all_moved) return note_moved(all_moved->states);
    others_start_ = false;
    options_.tell("it does not start with all of its parameters and inputs changed a little (" +
                  all_moved.error().rule + ")" +
                  (process.alive() ? "; each is changed alone, for at most " + text::exact(options_.trials_s) + " s"
                                   : std::string()));
    const auto end = Clock::now() + std::chrono::duration<double>(options_.trials_s);
    std::size_t k = 0;
    for (; k < movable.size() && process.alive() && Clock::now() < end; ++k) {
      *movable[k].value += beside(k, before[k]);
      if (const auto moved = begin()) note_moved(moved->states);
      *movable[k].value = before[k];
    }
    tell_untried(std::span(movable).subspan(k));
  }

  void tell_untried(std::span<const Movable> untried) const {
    if (untried.empty()) return;
    constexpr std::size_t kMostNamed = 10;
    std::string names;
    for (const Movable& one : untried.first(std::min(untried.size(), kMostNamed)))
      text::add_to_list(names, fmu_.name_of(one.of));
    if (untried.size() > kMostNamed) names += " and " + std::to_string(untried.size() - kMostNamed) + " more";
    options_.tell("whether these move the start of a state was not tried: " + names +
                  "; write `start: fmu` for a state that they move");
  }

  Status read_starts(FmuProcess& process, const std::vector<std::size_t>& variables, std::span<const double> inputs) {
    if (variables.empty()) return {};
    std::span<const double> values;
    if (file_.co_simulation()) {
      const auto step = process.do_step(fmu_.start_time_s.value_or(0.0), 0.0, inputs, inputs);
      if (!step) return fail(step.error());
      values = step->outputs;
    } else {
      const auto evaluation = process.evaluate(fmu_.start_time_s.value_or(0.0), out_.beginning.states, inputs, {});
      if (!evaluation) return fail(evaluation.error());
      values = evaluation->outputs;
    }
    for (const std::size_t variable : variables) {
      const std::size_t size = fmu_.variables[variable].size;
      out_.starts[variable].assign(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(size));
      values = values.subspan(size);
    }
    return {};
  }

  [[nodiscard]] bool is_linked(std::size_t state) const {
    const auto links = fmu_.start_links.find(state);
    return links != fmu_.start_links.end() && std::ranges::any_of(links->second, [&](std::size_t variable) {
             const FmiCausality causality = fmu_.variables[variable].causality;
             return causality == FmiCausality::parameter || causality == FmiCausality::structuralParameter ||
                    causality == FmiCausality::input;
           });
  }

  void note_moved(std::span<const double> states) {
    constexpr double kRounding = 1e-9;
    for (std::size_t k = 0; k < states.size(); ++k) {
      const double size = std::max(std::abs(out_.beginning.states[k]), std::abs(states[k]));
      if (std::abs(states[k] - out_.beginning.states[k]) > kRounding * size) out_.linked[k] = true;
    }
  }

  const FmuFile& file_;
  const ModelDescription& fmu_;
  const ImportOptions& options_;
  ImportRows& rows_;
  double trial_s_;  ///< of one start that is only tried
  Clock::time_point trials_end_ = {};
  bool others_start_ = true;  ///< it starts with other parameters and inputs, too
  ImportStart out_;
};

}  // namespace

double ImportStart::of_parameter(const ModelDescription& fmu, const Element& element) const {
  const auto read = starts.find(element.variable);
  return (read == starts.end() ? fmu.variables[element.variable].start : read->second)[element.element];
}

Result<ImportStart> start_unit(const FmuFile& file, const ImportOptions& options, ImportRows& rows) {
  return UnitStart(file, options, rows).run();
}

}  // namespace sealwatch::fmi
