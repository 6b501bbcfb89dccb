#include "services/common/fmi/import_fmu.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <map>
#include <set>
#include <sstream>

#include "sealwatch/core/file.hpp"
#include "services/common/fmi/fmu_plant.hpp"
#include "services/common/fmi/fmu_process.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::fmi {
namespace {

using Clock = std::chrono::steady_clock;

// Of inputs, outputs and parameters alike; a plant file has a largest size (core/file.hpp).
constexpr std::size_t kMostInForce = 200;  ///< further ones come as comments,
constexpr std::size_t kMostListed = 600;   ///< and so many in all; where that is too long, none

std::string number(double value) {
  std::string result = text::exact(value);
  return result.find_first_of(".en") == std::string::npos ? result + ".0" : result;
}

std::string in_comment(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < 0x20; }, ' ');
  return text;
}

/// One row of the file: an element of the FMU and the name that stands for it.
struct Row {
  Element element;
  std::string name;     ///< in expressions
  std::string channel;  ///< of an output
  std::string unit;
  Conversion scale;
  std::string meaning;
  std::optional<std::size_t> state = {};  ///< that an output shows at the start
  bool alias = false;                     ///< and always: both are one variable of the binary
};

class Writer {
 public:
  Writer(const FmuFile& file, const std::string& path, const ImportOptions& options)
      : file_(file), fmu_(file.description()), path_(path), options_(options), trial_s_(options.trial_s) {}

  Result<std::string> write() {
    collect();
    if (const Status named = check_names(); !named) return fail(named.error());
    if (const Status started = start(); !started) return fail(started.error());
    name_rows();
    for (const std::size_t most : {kMostListed, kMostInForce})
      if (std::string text = written(most); text.size() <= kLongestYaml_bytes) return text;
    return fail(refusal(std::to_string(states_.size()) + " states",
                        "make a plant file longer than " + std::to_string(kLongestYaml_bytes) + " bytes",
                        "export the model with fewer states, or with shorter names"));
  }

 private:
  // `most`: rows of each group, comments among them.
  std::string written(std::size_t most) {
    out_ = {};
    listed_ = most;
    head();
    fmu_section();
    channels();
    parameter_rows();
    if (!file_.co_simulation()) {
      state_rows();
      site_rows();
    } else {
      out_
          << "\n# This FMU is for Co-Simulation alone: it integrates by itself and keeps its states, so that no law "
             "can be\n"
             "# added to its derivatives. fit, validate and explain work with its inputs, outputs, parameters and\n"
             "# sensors; explain asks no physics of it. Exported for Model Exchange it can be asked for physics too.\n";
    }
    return out_.str();
  }

  // Names of expressions: letters, digits and _; each once among the names of `taken`.
  static std::string name_for(const std::string& name, std::initializer_list<std::set<std::string>*> taken) {
    static const std::set<std::string> kTaken = {"t",    "pi",   "sqrt", "exp",  "log",   "sin",  "cos",
                                                 "tan",  "asin", "acos", "atan", "tanh",  "abs",  "min",
                                                 "max",  "sign", "step", "root", "hypot", "rate", "mean",
                                                 "time", "null", "Null", "NULL"};  // the last are no text in YAML
    std::string result;
    for (const unsigned char c : name)
      if (std::isalnum(c) != 0 || c == '_')
        result += static_cast<char>(c);
      else if (!result.empty() && result.back() != '_')
        result += '_';
    while (result.size() > 1 && result.back() == '_') result.pop_back();
    if (result.empty() || std::isdigit(static_cast<unsigned char>(result[0])) != 0 || result.starts_with("fmu_"))
      result = "v_" + result;
    const auto is_taken = [&](const std::set<std::string>* names) { return names->contains(result); };
    while (kTaken.contains(result) || std::ranges::any_of(taken, is_taken)) result += "_";
    for (std::set<std::string>* names : taken) names->insert(result);
    return result;
  }

  // Quantities of expressions and recorded channels are two sets of names, to both of which inputs belong: a state and
  // the channel that shows it may have one name. States come first.
  void name_rows() {
    for (Row& row : states_) row.name = name_for(fmu_.name_of(row.element), {&quantities_});
    for (Row& row : inputs_) row.name = name_for(fmu_.name_of(row.element), {&quantities_, &channels_});
    for (Row& row : outputs_) {
      row.channel = name_for(fmu_.name_of(row.element), {&channels_});
      row.name = row.alias ? "" : name_for(fmu_.name_of(row.element), {&quantities_});
    }
    for (Row& row : parameters_) row.name = name_for(fmu_.name_of(row.element), {&quantities_});
  }

  [[nodiscard]] Row row_of(const Element& element) const {
    const Variable& variable = fmu_.variables[element.variable];
    Row row{.element = element, .name = {}, .channel = {}, .unit = "1", .scale = {}, .meaning = variable.description};
    if (const auto si = fmu_.si_unit_of(variable)) row.unit = si->name, row.scale = si->conversion;
    if (row.meaning.empty()) row.meaning = fmu_.name_of(element);
    if (variable.unit.empty() || row.unit == "1")
      row.meaning += variable.unit.empty() ? "" : " [" + variable.unit + "]";
    return row;
  }

  static bool is_number(FmiType type) {
    return type != FmiType::string && type != FmiType::binary && type != FmiType::clock;
  }

  void collect() {
    if (!file_.co_simulation())
      for (const Element& state : fmu_.states) states_.push_back(row_of(state));
    for (std::size_t k = 0; k < fmu_.variables.size(); ++k) {
      const Variable& variable = fmu_.variables[k];
      if (!is_number(variable.type)) continue;
      const bool real = variable.type == FmiType::float64 || variable.type == FmiType::float32;
      std::vector<Row>* rows = nullptr;
      if (variable.causality == FmiCausality::input) rows = &inputs_;
      if (variable.causality == FmiCausality::output) rows = &outputs_;
      if (variable.causality == FmiCausality::parameter && real && variable.variability != FmiVariability::constant &&
          !file_.settings().contains(variable.name))
        rows = &parameters_;
      for (std::size_t element = 0; rows != nullptr && element < variable.size; ++element)
        rows->push_back(row_of({k, element}));
    }
    for (Row& output : outputs_)
      for (std::size_t k = 0; k < states_.size(); ++k)
        if (is_alias(output.element, states_[k].element)) output.state = k, output.alias = true;
  }

  // The file names variables: of two with one name it would take the first.
  [[nodiscard]] Status check_names() const {
    std::map<std::string_view, int> count;
    for (const Variable& variable : fmu_.variables) ++count[variable.name];
    for (const auto* rows : {&states_, &inputs_, &outputs_, &parameters_})
      for (const Row& row : *rows)
        if (const std::string& name = fmu_.variables[row.element.variable].name; count[name] > 1)
          return fail(refusal(name, "is the name of two variables", "give each a name of its own, and export again"));
    return {};
  }
  [[nodiscard]] Error refusal(std::string value, std::string rule, std::string advice) const {
    return {.file = file_.name(),
            .place = {},
            .value = std::move(value),
            .rule = std::move(rule),
            .advice = std::move(advice)};
  }

  [[nodiscard]] bool is_alias(const Element& output, const Element& state) const {
    const Variable& variable = fmu_.variables[output.variable];
    return fmu_.variables[state.variable].reference == variable.reference && state.element == output.element &&
           variable.type == FmiType::float64;
  }

  // What drives the running model; what is read of it are starts that the description lacks.
  [[nodiscard]] Selection driven() const {
    Selection selection;
    for (const Row& row : inputs_)
      if (row.element.element == 0) selection.inputs.push_back(row.element.variable);
    for (const Row& row : parameters_)
      if (row.element.element == 0)
        (fmu_.variables[row.element.variable].start.empty() ? selection.outputs : selection.parameters)
            .push_back(row.element.variable);
    return selection;
  }
  [[nodiscard]] std::vector<double> starts_of(const std::vector<std::size_t>& variables) const {
    std::vector<double> values;
    for (const std::size_t variable : variables) {
      const Variable& of = fmu_.variables[variable];
      for (std::size_t k = 0; k < of.size; ++k) values.push_back(of.start.empty() ? 0.0 : of.start[k]);
    }
    return values;
  }

  // The states' values and sizes are known to the running model alone, and so are starts that the description lacks.
  Status start() {
    Selection selection = driven();
    const auto setup = file_.setup(selection);
    if (!setup) return fail(setup.error());
    std::vector<double> inputs = starts_of(selection.inputs);
    std::vector<double> parameters = starts_of(selection.parameters);
    auto process = FmuProcess::start(file_.name(), *setup, 1);
    if (!process) return fail(process.error());
    const std::vector<double> steps(states_.size(), 1e-7), input_steps(inputs.size(), 1e-7);
    const auto begin = [&] {
      return (*process)->begin({.start_time_s = fmu_.start_time_s.value_or(0.0),
                                .state_steps = steps,
                                .input_steps = input_steps,
                                .inputs = inputs,
                                .parameters = parameters});
    };
    const auto before = Clock::now();
    auto beginning = begin();
    if (!beginning) return fail(beginning.error());
    constexpr double kSlower = 3.0;  // than the first start
    trial_s_ = std::max(trial_s_, kSlower * std::chrono::duration<double>(Clock::now() - before).count());
    beginning_ = std::move(*beginning);
    if (const Status read = read_starts(**process, selection.outputs, inputs); !read) return fail(read.error());
    linked_.assign(states_.size(), false);
    for (std::size_t k = 0; k < states_.size(); ++k) linked_[k] = is_linked(states_[k].element.variable);
    leave_to_unit();
    if (states_.empty()) return {};
    std::vector<Movable> movable;
    add_movable(selection.inputs, inputs, movable);
    std::erase_if(movable,
                  [&](const Movable& one) { return !changes_between_events(fmu_.variables[one.of.variable]); });
    add_movable(selection.parameters, parameters, movable);
    (*process)->limit_start(trial_s_);
    try_changes(movable, begin, **process);
    find_shown_states();
    return {};
  }

  // What is no number cannot be written, and is left to the unit.
  void leave_to_unit() {
    for (std::size_t k = 0; k < states_.size(); ++k) {
      if (std::isfinite(beginning_.states[k])) continue;
      linked_[k] = true;
      options_.tell("the state " + fmu_.name_of(states_[k].element) +
                    " starts at no finite number: the file leaves its start to the unit (start: fmu)");
    }
    std::set<std::size_t> without;
    for (const Row& row : parameters_)
      if (!std::isfinite(start_of_parameter(row.element)) && without.insert(row.element.variable).second)
        options_.tell("the parameter " + fmu_.variables[row.element.variable].name +
                      " has no finite value: it is left out, and the unit keeps its own");
    std::erase_if(parameters_, [&](const Row& row) { return without.contains(row.element.variable); });
  }

  // Outputs that have a state's value at the start, and beside it with other values of what it starts with: that state
  // may begin at the output's first sample. Elsewhere they may differ (a sensor that saturates), so that they stay
  // variables of their own. What fails here is no fault: then nothing is known of them.
  void find_shown_states() {
    Selection selection = driven();
    selection.outputs.clear();
    for (const Row& row : outputs_)
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
    const std::vector<double> steps(states_.size(), 1e-7), input_steps(inputs.size(), 1e-7);
    const double time_s = fmu_.start_time_s.value_or(0.0);
    const auto begun = (*process)->begin({.start_time_s = time_s,
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
      for (Row& output : outputs_) {
        if (output.element.variable != variable) continue;
        const double value = values[output.element.element];
        for (std::size_t k = 0; k < states.size() && !output.state; ++k)
          if (std::abs(value - states[k]) <= kRounding * std::abs(states[k]) && output.unit == states_[k].unit &&
              output.scale.factor == states_[k].scale.factor && output.scale.offset == states_[k].scale.offset)
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
      names += (names.empty() ? "" : ", ") + fmu_.name_of(one.of);
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
      const auto evaluation = process.evaluate(fmu_.start_time_s.value_or(0.0), beginning_.states, inputs, {});
      if (!evaluation) return fail(evaluation.error());
      values = evaluation->outputs;
    }
    for (const std::size_t variable : variables) {
      const std::size_t size = fmu_.variables[variable].size;
      starts_[variable].assign(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(size));
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
      const double size = std::max(std::abs(beginning_.states[k]), std::abs(states[k]));
      if (std::abs(states[k] - beginning_.states[k]) > kRounding * size) linked_[k] = true;
    }
  }

  [[nodiscard]] double start_of_parameter(const Element& element) const {
    const auto read = starts_.find(element.variable);
    return (read == starts_.end() ? fmu_.variables[element.variable].start : read->second)[element.element];
  }

  // Elements of an array are of one size and of either sign.
  [[nodiscard]] double reach_of_array(const Row& row) const {
    double size = 0.0;
    for (std::size_t k = 0; k < fmu_.variables[row.element.variable].size; ++k)
      size = std::max(size, std::abs(row.scale.to_si(start_of_parameter({row.element.variable, k}))));
    return size == 0.0 ? 1.0 : 10.0 * size;
  }

  void head() {
    const std::string version = fmu_.version == Version::fmi2 ? "FMI 2.0" : "FMI 3.0";
    out_ << "# A plant for sealwatch around the FMU " << in_comment(path_) << " (" << version << ", "
         << (file_.co_simulation() ? "Co-Simulation" : "Model Exchange")
         << (fmu_.tool.empty() ? "" : ", made by " + in_comment(fmu_.tool)) << ").\n"
         << "# Written by `sealwatch plant import`; complete what the comments ask for, then `sealwatch plant check` "
            "it.\n"
         << "# All units are SI: the FMU's own are converted.\n";
    if (file_.interface().needs_execution_tool)
      out_ << "# It runs only where " << (fmu_.tool.empty() ? "the tool that made it" : in_comment(fmu_.tool))
           << " is installed (needsExecutionTool).\n";
    out_ << "\nname: " << name_for(fmu_.model_name, {}) << "\n"
         << "meaning: " << text::quoted(fmu_.description.empty() ? "the FMU " + fmu_.model_name : fmu_.description)
         << "\n";
  }

  // What is no quantity that a fit could move: as it was set, and as a comment what else could be.
  void settings() {
    if (!file_.settings().empty()) out_ << "  settings:      # of the FMU, set once before a run\n";
    for (const auto& [name, text] : file_.settings())
      out_ << "    " << text::quoted(name) << ": " << text::quoted(text) << "\n";
    std::size_t count = 0;
    for (const Variable& variable : fmu_.variables) {
      const bool real = variable.type == FmiType::float64 || variable.type == FmiType::float32;
      const bool structural = variable.causality == FmiCausality::structuralParameter;
      if (!(structural || (variable.causality == FmiCausality::parameter && !real)) ||
          variable.variability == FmiVariability::constant || file_.settings().contains(variable.name))
        continue;
      if (++count > listed_) continue;
      if (count == 1)
        out_ << "  # Parameters that can be set once, under `settings` (sizes of arrays: import with --set):\n";
      out_ << "  #   " << in_comment(text::quoted(variable.name)) << ":";
      for (const double value : variable.start) out_ << " " << number(value);
      out_ << "\n";
    }
  }

  template <class Write>
  void list(const std::vector<Row>& rows, const char* indent, const Write& write) {
    for (std::size_t k = 0; k < std::min(rows.size(), listed_); ++k) {
      out_ << indent << (k < kMostInForce ? "" : "# ");
      write(rows[k]);
      out_ << "\n";
    }
  }
  void count_rest(const std::vector<Row>& rows, const char* other_place) {
    if (rows.size() > listed_)
      out_ << "  # ... and " << rows.size() - listed_
           << " more: add those of modelDescription.xml that you need, here and in " << other_place << "\n";
  }

  void fmu_section() {
    out_ << "\nfmu:\n  file: " << text::quoted(path_) << "\n  interface: " << (file_.co_simulation() ? "cs" : "me");
    if (!file_.co_simulation() && fmu_.co_simulation)
      out_ << "  # it has Co-Simulation too: with its own solver (--interface cs), as published results of it are";
    out_ << "\n";
    settings();
    if (!inputs_.empty()) out_ << "  inputs:        # of the FMU, each an expression of the recorded inputs below\n";
    const auto name = [&](const Row& row) { out_ << text::quoted(fmu_.name_of(row.element)) << ": " << row.name; };
    list(inputs_, "    ", name);
    if (!parameters_.empty()) out_ << "  parameters:    # of the FMU, each an expression of the parameters below\n";
    list(parameters_, "    ", name);
    out_ << "  variables:     # of the FMU, by the names that expressions use; any of its variables may be added\n";
    for (std::size_t k = 0; k < std::min(outputs_.size(), listed_); ++k)
      if (const Row& row = outputs_[k]; !row.alias)
        out_ << (k < kMostInForce ? "    " : "    # ") << row.name
             << ": {variable: " << text::quoted(fmu_.name_of(row.element)) << ", unit: " << text::quoted(row.unit)
             << "}\n";
  }

  void channels() {
    if (!inputs_.empty())
      out_ << "\n# Recorded inputs. Rename them to the recording's columns (here and in fmu.inputs); delete those that "
              "are not\n"
              "# recorded: the FMU then keeps its own start value.\n"
              "inputs:\n";
    list(inputs_, "  ", [&](const Row& row) {
      out_ << row.name << ": {unit: " << text::quoted(row.unit)
           << (changes_between_events(fmu_.variables[row.element.variable]) ? "" : ", course: held")
           << ", meaning: " << text::quoted(row.meaning) << "}";
    });
    count_rest(inputs_, "fmu.inputs");
    out_ << "\n# Recorded outputs. Rename them to the recording's columns, delete those that are not recorded.\n"
            "# noise_std: what the sensor's noise is; without it the recordings tell.\n"
            "outputs:\n";
    list(outputs_, "  ", [&](const Row& row) {
      out_ << row.channel << ": {unit: " << text::quoted(row.unit) << ", value: " << shown(row)
           << ", meaning: " << text::quoted(row.meaning) << "}";
    });
    count_rest(outputs_, "fmu.variables");
    if (outputs_.empty())
      out_ << "  {}  # the FMU declares none: name variables of it in fmu.variables and use them here\n";
  }

  [[nodiscard]] const Row* state_shown_by(const Row& output) const {
    return output.state ? &states_[*output.state] : nullptr;
  }
  // An output that is a state, under its own or another name, is taken as the state, which costs nothing.
  [[nodiscard]] std::string shown(const Row& output) const {
    return output.alias ? state_shown_by(output)->name : output.name;
  }

  void parameter_rows() {
    if (parameters_.empty()) return;
    out_ << "\n# Parameters. Set `estimate: true` for those that fit may change, with bounds that you believe in.\n"
            "parameters:\n";
    list(parameters_, "  ", [&](const Row& row) {
      const Variable& variable = fmu_.variables[row.element.variable];
      const double value = row.scale.to_si(start_of_parameter(row.element));
      const double reach = value == 0.0 ? 1.0 : 9.0 * std::abs(value);
      double min = value > 0.0 ? value / 10.0 : value - reach, max = value < 0.0 ? value / 10.0 : value + reach;
      if (variable.size > 1) max = reach_of_array(row), min = -max;
      if (variable.min) min = std::max(min, row.scale.to_si(*variable.min));
      if (variable.max) max = std::min(max, row.scale.to_si(*variable.max));
      const bool sound = min <= value && value <= max && min < max;
      if (!sound) min = value - reach, max = value + reach;
      out_ << row.name << ": {unit: " << text::quoted(row.unit) << ", value: " << number(value)
           << ", min: " << number(min) << ", max: " << number(max)
           << ", estimate: false, meaning: " << text::quoted(row.meaning) << "}";
    });
    count_rest(parameters_, "fmu.parameters");
  }

  void state_rows() {
    if (states_.empty()) return;
    out_ << "\n# States. `start` may be a channel, whose first value is taken, or rate(channel); a list is tried in "
            "turn.\n"
            "# start: fmu is the FMU's own, which its parameters or first inputs move.\n"
            "# size: how large it usually is (the integration keeps to a share of it).\n"
            "# own: true where each recording has a start of its own, which is estimated: here for the states that an "
            "output shows,\n"
            "# which begin at its first sample. The others begin at the FMU's start in every recording (own: false).\n"
            "states:\n";
    for (std::size_t k = 0; k < states_.size(); ++k) {
      const Row& row = states_[k];
      const double start = row.scale.to_si(beginning_.states[k]);
      const double nominal = std::abs(row.scale.factor * beginning_.nominals[k]);
      const bool usual = std::isfinite(nominal) && nominal > 0.0;
      out_ << "  " << row.name << ": {variable: " << text::quoted(fmu_.name_of(row.element))
           << ", unit: " << text::quoted(row.unit) << ", start: " << (linked_[k] ? kStartOfFmu : start_of(row, start))
           << ", size: " << number(usual ? nominal : 1.0)
           << ", own: " << (!linked_[k] && shown_by_output(row) ? "true" : "false")
           << ", meaning: " << text::quoted(row.meaning) << "}\n";
    }
  }

  [[nodiscard]] std::span<const Row> recorded() const {
    return std::span(outputs_).first(std::min(outputs_.size(), kMostInForce));
  }
  [[nodiscard]] bool shown_by_output(const Row& state) const {
    return std::ranges::any_of(recorded(), [&](const Row& output) { return state_shown_by(output) == &state; });
  }

  [[nodiscard]] std::string start_of(const Row& state, double value) const {
    std::string here = text::quoted(number(value) + "[" + state.unit + "]");
    for (const Row& output : recorded())
      if (state_shown_by(output) == &state) return "[" + output.channel + ", " + here + "]";
    return here;
  }

  void site_rows() {
    out_ << "\n# Where physics may be missing: elements with sites, at which the laws of the catalogue (docs/laws.md) "
            "are tried.\n"
            "# What a law adds goes to the derivatives of states, with a factor; a loss counts positive. Or a site "
            "gets a\n"
            "# symbol, which an input of the FMU may contain. For a force on a mass M with the velocity v and the "
            "position x:\n"
            "# elements:\n"
            "#   piston:\n"
            "#     meaning: force on the piston\n"
            "#     sites:\n"
            "#       - {kind: piston_force, adds_to: {v: -1/M}, signals: {speed: v, position: x}}\n"
            "# Its derivatives are:";
    for (const Element& derivative : fmu_.derivatives) out_ << " " << in_comment(fmu_.name_of(derivative));
    out_ << "\nelements: {}\n"
            "\n# With sites: how many times larger each unit of their laws is here than on a 60 kN actuator; `plant "
            "check`\n"
            "# lists the units that are missing. For example {N: 0.02, m: 1, m/s: 10}.\n"
            "law_sizes: {}\n";
  }

  const FmuFile& file_;
  const ModelDescription& fmu_;
  const std::string& path_;
  const ImportOptions& options_;
  std::size_t listed_ = 0;    ///< rows of each group, at most
  double trial_s_;            ///< of one start that is only tried
  bool others_start_ = true;  ///< it starts with other parameters and inputs, too
  std::set<std::string> quantities_, channels_;
  std::map<std::size_t, std::vector<double>> starts_;  ///< of parameters that the description gives none
  std::vector<bool> linked_;  ///< of each state, whether a parameter or an input moves its start
  std::vector<Row> inputs_, outputs_, parameters_, states_;
  Beginning beginning_;
  std::ostringstream out_;
};

}  // namespace

Result<std::string> plant_file_of(const FmuFile& file, const std::string& path, const ImportOptions& options) {
  return Writer(file, path, options).write();
}

}  // namespace sealwatch::fmi
