#include "services/common/fmi/fmu_plant.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>

#include "sealwatch/core/file.hpp"
#include "sealwatch/core/rate_unit.hpp"
#include "sealwatch/core/text.hpp"
#include "services/common/equations/dimension.hpp"
#include "services/common/equations/plant_names.hpp"
#include "services/common/fmi/declared_dependencies.hpp"
#include "services/common/fmi/derived_outputs.hpp"
#include "services/common/fmi/fmu_equations.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch::fmi {
namespace {

using equations::Dimension;
using equations::TextPlant;

Error fault(std::string value, std::string rule, std::string advice = {}) {
  return {.file = {}, .place = {}, .value = std::move(value), .rule = std::move(rule), .advice = std::move(advice)};
}

class Builder {
 public:
  Builder(const TextPlant& text, const FmuSection& section, const equations::Faults& faults)
      : text_(text), section_(section), faults_(faults) {}

  std::optional<equations::BuiltPlant> build() {
    auto file = FmuFile::open(section_.file, section_.settings, section_.interface);
    if (!file) return complain_of_file(file.error()), std::nullopt;
    block_.file = *file;
    if (!text_.file.empty())
      block_.plant = {.file = std::filesystem::absolute(text_.file).string(),
                      .hash = content_hash(read_file(text_.file, kLongestYaml_bytes).value_or("")),
                      .fmu_folder = block_.file->unpacked().folder.path().string()};
    description_ = &block_.file->description();
    order_states();
    choose_variables();
    if (!sound_) return std::nullopt;
    write_frame();
    check_inputs();
    check_parameters();
    auto built = equations::build_plant(frame_, [&](const std::string& key, const Error& error) {
      const auto of = keys_.find(key.substr(0, key.rfind('.')));
      complain(of == keys_.end() ? key : of->second, error);
    });
    if (!built || !sound_) return std::nullopt;
    const auto undeclared = check_dependencies(block_);
    if (!undeclared) return complain("fmu.file", undeclared.error()), std::nullopt;
    if (!undeclared->empty()) built->remarks.push_back(*undeclared);
    if (const Status honest = check_derivatives(block_); !honest)
      return complain("fmu.file", honest.error()), std::nullopt;
    note_what_laws_do_not_reach(built->remarks);
    if (!undefined_units_.empty()) built->remarks.push_back(undefined_units_ + ": " + kUndefinedUnits);
    strip(built->plant);
    return built;
  }

 private:
  void complain(const std::string& key, const Error& error) {
    sound_ = false;
    faults_(key, error);
  }

  // A setting's fault stands at its own line.
  void complain_of_file(Error error) {
    const bool of_setting = error.place.starts_with(kSettingPlace);
    const std::string key =
        of_setting ? "fmu.settings." + error.place.substr(std::string_view(kSettingPlace).size()) : "fmu.file";
    if (of_setting) error.place.clear();
    complain(key, error);
  }

  // The plant's states are the FMU's, in any order; those of the frame stand in the FMU's.
  void order_states() {
    frame_ = text_;
    frame_.states.clear();
    if (block_.file->co_simulation()) {
      if (!text_.states.empty())
        complain("states", fault(text_.states[0].description.name, "cannot be a state: the FMU is for Co-Simulation",
                                 "such a unit keeps its states to itself: leave out `states`"));
      if (!text_.sites.empty())
        complain(text_.sites[0].key, fault(text_.sites[0].element, "cannot be a site: the FMU is for Co-Simulation",
                                           "export it for Model Exchange: then laws can be added to its derivatives"));
      return;
    }
    for (const Element& state : description_->states) {
      const std::string name = description_->name_of(state);
      const auto row = std::ranges::find(section_.states, name);
      if (row == section_.states.end()) {
        complain("states", fault(name, "is a state of the FMU and is missing", "add it with variable: " + name));
        continue;
      }
      frame_.states.push_back(text_.states[static_cast<std::size_t>(row - section_.states.begin())]);
      equations::TextState& of = frame_.states.back();
      const std::string key = "states." + of.description.name;
      take_start(key + ".start", of);
      block_.states.push_back(conversion(key, description_->variables[state.variable], of.description.unit));
      block_.state_sizes.push_back(of.size.value_or(1.0));
      if (!of.size) complain(key, fault(of.description.name, "has no size", "give size: how large it usually is"));
    }
    for (std::size_t k = 0; k < text_.states.size(); ++k)
      if (std::ranges::none_of(description_->states, [&](const Element& state) {
            return description_->name_of(state) == section_.states[k];
          })) {
        std::vector<std::string> names;
        for (const Element& state : description_->states) names.push_back(description_->name_of(state));
        complain("states." + text_.states[k].description.name,
                 fault(section_.states[k], "is not a state of the FMU", suggest(section_.states[k], names)));
      }
  }

  // Where the FMU itself says the start, the frame has nothing to understand.
  void take_start(const std::string& key, equations::TextState& state) {
    const bool by_fmu = std::ranges::find(state.start, kStartOfFmu) != state.start.end();
    starts_by_fmu_.push_back(by_fmu);
    if (!by_fmu) return;
    if (state.start.size() > 1)
      complain(key, fault(kStartOfFmu, "stands beside other starts", "the FMU always has a start: give it alone"));
    state.start = {"0[" + state.description.unit + "]"};
    state.own = false;
  }

  // From the unit that the FMU declares to SI; where it declares none it counts in the plant file's.
  Conversion conversion(const std::string& key, const Variable& variable, const std::string& unit) {
    const auto declared = description_->si_unit_of(variable);
    if (!declared) return {};
    const auto here = equations::find_dimension(unit), there = equations::find_dimension(declared->name);
    if (here && there && !(*here == *there))
      complain(key, fault(unit, "is another quantity than the FMU's unit " + variable.unit,
                          "the FMU says that this is in " + declared->name));
    return declared->conversion;
  }

  void choose_variables() {
    Selection selection;
    std::vector<Element> inputs, parameters, outputs;
    const auto choose = [&](const std::string& key, const std::string& name, std::vector<Element>& elements,
                            std::vector<std::size_t>& whole) {
      const Result<Element> element = description_->find_element(name);
      if (!element) return complain(key, element.error());
      elements.push_back(*element);
      if (std::ranges::find(whole, element->variable) == whole.end()) whole.push_back(element->variable);
    };
    const auto check = [&](const std::string& key, const std::string& name, FmiCausality causality) {
      const Variable* variable = description_->find(name.substr(0, name.find('[')));
      if (variable != nullptr && variable->causality != causality)
        complain(key, fault(name, "is declared as " + std::string(name_of(variable->causality)) +
                                      " in the FMU, not as " + std::string(name_of(causality))));
    };
    for (const auto& [name, value] : section_.inputs)
      choose("fmu.inputs." + name, name, inputs, selection.inputs),
          check("fmu.inputs." + name, name, FmiCausality::input);
    for (const auto& [name, value] : section_.parameters) {
      const std::string key = "fmu.parameters." + name;
      choose(key, name, parameters, selection.parameters), check(key, name, FmiCausality::parameter);
      if (section_.settings.contains(name.substr(0, name.find('['))))
        complain(key, fault(name, "is among the settings too", "leave one of both out"));
    }
    check_arrays(parameters);
    for (const FmuVariable& variable : section_.variables)
      choose("fmu.variables." + variable.name, variable.variable, outputs, selection.outputs);
    if (!sound_) return;
    note_units(selection);
    const auto setup = block_.file->setup(selection);
    if (!setup) return complain("fmu", setup.error());
    block_.setup = *setup;
    block_.start_time_s = description_->start_time_s.value_or(0.0);
    block_.stop_time_s = description_->stop_time();
    block_.inputs = ports(inputs, selection.inputs, block_.input_start);
    block_.input_sizes = nominals(selection.inputs);
    block_.parameters = ports(parameters, selection.parameters, block_.parameter_start);
    std::vector<double> unused;
    block_.variables = ports(outputs, selection.outputs, unused);
    for (std::size_t k = 0; k < section_.variables.size(); ++k)
      block_.variables[k].unit = conversion("fmu.variables." + section_.variables[k].name,
                                            description_->variables[outputs[k].variable], section_.variables[k].unit);
    units_of(inputs, input_units_, block_.inputs);
    units_of(parameters, parameter_units_, block_.parameters);
  }

  void note_units(const Selection& selection) {
    std::vector<std::size_t> used;
    for (const auto* list : {&selection.inputs, &selection.parameters, &selection.outputs})
      used.insert(used.end(), list->begin(), list->end());
    if (!block_.file->co_simulation())
      for (const Element& state : description_->states)
        if (state.element == 0) used.push_back(state.variable);
    std::ranges::sort(used);
    used.erase(std::ranges::unique(used).begin(), used.end());
    undefined_units_ = undefined_units(*description_, used);
  }

  // An array is set whole: what is not given must have a start.
  void check_arrays(const std::vector<Element>& parameters) {
    for (const Element& element : parameters) {
      const Variable& of = description_->variables[element.variable];
      const auto given = std::ranges::count(parameters, element.variable, &Element::variable);
      if (of.start.empty() && given < static_cast<std::ptrdiff_t>(of.size))
        complain("fmu.parameters." + description_->name_of(element),
                 fault(of.name, "has no start value in the description, and not all of its elements are given",
                       "give all " + std::to_string(of.size)));
    }
  }

  // They are set once, with recorded inputs at their first sample: what the FMU itself gives is not known there.
  void check_parameters() {
    equations::Expressions expressions;
    const equations::Faults quiet = [](const std::string&, const Error&) {};
    equations::PlantNames names(frame_, expressions, quiet);
    const equations::VariablePlaces places = names.places();
    for (const auto& [name, value] : section_.parameters) {
      const auto formula = equations::understand(value, expressions, names);
      if (!formula) continue;  // told by the frame
      const std::vector<bool> used = expressions.variables_of(std::array{formula->node}, places.count);
      if (std::find(used.begin() + static_cast<std::ptrdiff_t>(places.added), used.end(), true) == used.end()) continue;
      complain("fmu.parameters." + name,
               fault(value, "is set once, before the FMU has values of its own or a law adds anything",
                     "use parameters and inputs of this file; for a start that each recording has of its own give the "
                     "recordings a column with it, as an input, whose first value is taken"));
    }
  }

  // An input that is discrete in the FMU changes at events, which are where held inputs jump.
  void check_inputs() {
    equations::Expressions expressions;
    const equations::Faults quiet = [](const std::string&, const Error&) {};
    equations::PlantNames names(frame_, expressions, quiet);
    const equations::VariablePlaces places = names.places();
    block_.held_inputs.assign(section_.inputs.size(), false);
    for (std::size_t k = 0; k < section_.inputs.size(); ++k) {
      const auto& [name, value] = section_.inputs[k];
      const auto formula = equations::understand(value, expressions, names);
      if (!formula) continue;  // told by the frame
      const std::vector<bool> used = expressions.variables_of(std::array{formula->node}, places.count);
      std::string moving;
      for (std::size_t input = 0; input < frame_.inputs.size(); ++input)
        if (used[places.inputs + input] && frame_.inputs[input].course != InputCourse::held)
          moving = frame_.inputs[input].channel.name;
      for (std::size_t other = 0; other < used.size(); ++other)
        if (used[other] &&
            (other < places.inputs || (other >= places.rates && other < places.parameters) || other >= places.added))
          moving = value;
      block_.held_inputs[k] = moving.empty();
      if (!moving.empty() && block_.inputs[k].place >= elements(continuous_inputs()))
        complain("fmu.inputs." + name,
                 fault(moving, "changes between samples, and drives " + name + ", which may change at events alone",
                       "give the input `course: held`"));
    }
  }
  [[nodiscard]] std::span<const Handle> continuous_inputs() const {
    return std::span(block_.setup.inputs).first(block_.setup.continuous_inputs);
  }

  // Places among the elements of the whole variables, in the order of the setup, and the start values of all.
  [[nodiscard]] std::vector<Port> ports(const std::vector<Element>& elements, const std::vector<std::size_t>& whole,
                                        std::vector<double>& start) const {
    std::map<std::size_t, std::size_t> first;
    for (const std::size_t variable : whole) {
      const Variable& of = description_->variables[variable];
      first[variable] = start.size();
      for (std::size_t k = 0; k < of.size; ++k) start.push_back(of.start.empty() ? 0.0 : of.start[k]);
    }
    std::vector<Port> result;
    result.reserve(elements.size());
    for (const Element& element : elements)
      result.push_back({.place = first[element.variable] + element.element, .unit = {}});
    return result;
  }

  // Of each element of whole variables; 1 where none is said, as FMI has it.
  [[nodiscard]] std::vector<double> nominals(const std::vector<std::size_t>& whole) const {
    std::vector<double> result;
    for (const std::size_t variable : whole) {
      const Variable& of = description_->variables[variable];
      const double size = std::abs(of.nominal.value_or(1.0));
      result.insert(result.end(), of.size, std::isfinite(size) && size > 0.0 ? size : 1.0);
    }
    return result;
  }

  void units_of(const std::vector<Element>& elements, std::vector<std::string>& units, std::vector<Port>& to) const {
    for (std::size_t k = 0; k < elements.size(); ++k) {
      const auto si = description_->si_unit_of(description_->variables[elements[k].variable]);
      units.push_back(si ? si->name : "");
      if (si) to[k].unit = si->conversion;
    }
  }

  // The text around the FMU: its derivatives and variables are what is "added" first, its inputs and parameters are
  // outputs behind the plant's own.
  void write_frame() {
    std::vector<equations::TextSite> sites;
    const auto from_fmu = [&](const std::string& symbol, const std::string& unit, const std::string& key) {
      sites.push_back({.element = "fmu",
                       .kind = SiteKind::own,
                       .symbol = symbol,
                       .unit = unit,
                       .signals = {},
                       .adds_to = {},
                       .key = key});
    };
    for (std::size_t k = 0; k < frame_.states.size(); ++k) {
      equations::TextState& state = frame_.states[k];
      state.rate = "fmu_derivative_" + std::to_string(k + 1);
      from_fmu(state.rate, "1/s " + state.description.unit, "states." + state.description.name);
    }
    for (const FmuVariable& variable : section_.variables)
      from_fmu(variable.name, variable.unit, "fmu.variables." + variable.name);
    frame_.sites.insert(frame_.sites.begin(), sites.begin(), sites.end());
    for (std::size_t k = 0; k < section_.inputs.size(); ++k)
      to_fmu("fmu.inputs." + section_.inputs[k].first, section_.inputs[k].second, input_units_[k]);
    for (std::size_t k = 0; k < section_.parameters.size(); ++k)
      to_fmu("fmu.parameters." + section_.parameters[k].first, section_.parameters[k].second, parameter_units_[k]);
    for (const equations::TextSite& site : sites) to_fmu(site.key, site.symbol, site.unit);
  }

  void to_fmu(const std::string& key, const std::string& value, std::string unit) {
    if (unit.empty()) unit = unit_of(value);
    const std::string name = "fmu_" + std::to_string(keys_.size() + 1);
    keys_["outputs." + name] = key;
    frame_.outputs.push_back({.channel = {.name = name, .unit = unit, .meaning = key}, .value = value});
  }

  // Where the FMU declares no unit, whatever unit an expression has is right.
  [[nodiscard]] std::string unit_of(const std::string& value) const {
    equations::Expressions expressions;
    const equations::Faults quiet = [](const std::string&, const Error&) {};
    equations::PlantNames names(frame_, expressions, quiet);
    const auto formula = equations::understand(value, expressions, names);
    return formula ? equations::words_of(formula->dimension) : "1";
  }

  /// What an output's expression contains: names are those of PlantNames::places().
  [[nodiscard]] std::vector<bool> used_by(const equations::TextOutput& output, std::size_t& added) const {
    equations::Expressions expressions;
    const equations::Faults quiet = [](const std::string&, const Error&) {};
    equations::PlantNames names(frame_, expressions, quiet);
    added = names.places().added;
    const auto formula = equations::understand(output.value, expressions, names);
    if (!formula) return std::vector<bool>(names.places().count);
    return expressions.variables_of(std::array{formula->node}, names.places().count);
  }

  // An output that the FMU computes from a derivative does not see what a law adds to that behind the FMU. The process
  // that runs simulations has nobody to tell it.
  void note_what_laws_do_not_reach(std::vector<std::string>& remarks) const {
    struct Pair {
      const equations::TextSite* site;
      const std::pair<std::string, std::string>* adds;
      const equations::TextOutput* output;
      std::size_t state, variable;
    };
    std::vector<Pair> pairs;
    std::vector<std::size_t> states, variables;
    const std::size_t own = frame_.sites.size() - text_.sites.size();
    for (const equations::TextOutput& output : text_.outputs) {
      std::size_t added = 0;
      const std::vector<bool> used = used_by(output, added);
      for (std::size_t variable = 0; variable < section_.variables.size(); ++variable)
        for (std::size_t site = 0; site < text_.sites.size(); ++site) {
          if (!used[added + frame_.states.size() + variable] || used[added + own + site]) continue;
          for (const auto& adds : text_.sites[site].adds_to)
            for (std::size_t state = 0; state < frame_.states.size(); ++state)
              if (frame_.states[state].description.name == adds.first)
                pairs.push_back({&text_.sites[site], &adds, &output, state, variable});
        }
    }
    for (const Pair& pair : pairs) states.push_back(pair.state), variables.push_back(pair.variable);
    for (auto* list : {&states, &variables}) {
      std::ranges::sort(*list);
      list->erase(std::ranges::unique(*list).begin(), list->end());
    }
    if (pairs.empty() || local_hosts()) return;
    const auto derived = outputs_of_derivatives(block_, variables, states);
    if (!derived) return;  // a run says what fails
    for (const Pair& pair : pairs)
      for (const DerivedOutput& one : *derived)
        if (one.state == pair.state && one.variable == pair.variable)
          remarks.push_back(not_reached(*pair.site, *pair.adds, *pair.output, section_.variables[one.variable].name,
                                        factor_in_words(one), one.scaled));
  }

  /// As a formula has it: "0.102[s2/m]*".
  [[nodiscard]] std::string factor_in_words(const DerivedOutput& one) const {
    const auto variable = equations::find_dimension(section_.variables[one.variable].unit),
               rate = equations::find_dimension(rate_unit(frame_.states[one.state].description.unit));
    const std::string unit = variable && rate ? equations::words_of(multiply(*variable, *rate, -1.0)) : "1";
    constexpr double kOne = 1e-3;
    if (unit == "1" && std::abs(one.factor - 1.0) < kOne) return "";
    return text::general(one.factor) + (unit == "1" ? "" : "[" + unit + "]") + "*";
  }

  [[nodiscard]] static std::string not_reached(const equations::TextSite& site,
                                               const std::pair<std::string, std::string>& adds,
                                               const equations::TextOutput& output, const std::string& variable,
                                               const std::string& factor, bool scaled) {
    const std::string symbol = site.symbol.empty() ? site.element + "_law" : site.symbol;
    const std::string of = scaled ? " is in proportion to" : " from",
                      unless = scaled ? "unless it is the force or flow of one part alone, " : "";
    return "outputs." + output.channel.name + (scaled ? ": in the FMU " : ": the FMU computes ") + variable + of +
           " the derivative of " + adds.first + ", so that what " + site.key + ".adds_to adds to " + adds.first +
           " does not reach it, and results with this output can be false: " + unless + "give the site the symbol " +
           symbol + " and write (" + variable + " + " + factor + "(" + adds.second + ")*" + symbol + ") for " +
           variable + (scaled ? ", with what parameters make of " + factor.substr(0, factor.find('*')) : "") +
           ", or let the symbol stand in an input of the FMU in place of adds_to, or take the output out of the "
           "channels";
  }

  // Whether what laws add is seen at once by an output, or by an input of the FMU.
  [[nodiscard]] bool outputs_see_added() const {
    const std::size_t own = frame_.sites.size() - text_.sites.size();
    return std::ranges::any_of(frame_.outputs, [&](const equations::TextOutput& output) {
      std::size_t added = 0;
      const std::vector<bool> used = used_by(output, added);
      return std::any_of(used.begin() + static_cast<std::ptrdiff_t>(added + own), used.end(),
                         [](bool one) { return one; });
    });
  }

  void strip(RuntimePlant& plant) {
    const std::size_t outputs = text_.outputs.size(), sites = frame_.sites.size() - text_.sites.size();
    const auto of_frame = [](const std::string& name) { return name.starts_with("fmu_"); };
    plant.outputs.resize(outputs);
    std::erase_if(plant.description.channels,
                  [&](const ChannelDescription& row) { return of_frame(row.name) && !row.input; });
    std::erase_if(plant.description.elements, [&](const ElementDescription& row) {
      return row.name.starts_with("sensor:") && of_frame(row.name.substr(7));
    });
    plant.description.sites.erase(plant.description.sites.begin(),
                                  plant.description.sites.begin() + static_cast<std::ptrdiff_t>(sites));
    plant.description.hides_states = block_.file->co_simulation();
    for (std::size_t k = 0; k < starts_by_fmu_.size(); ++k) plant.states[k].by_equations = starts_by_fmu_[k];
    plant.equations = std::make_shared<FmuEquations>(
        std::move(block_), plant.equations,
        FmuEquations::Counts{.inputs = plant.inputs.size(), .outputs = outputs, .sites = text_.sites.size()},
        outputs_see_added());
  }

  const TextPlant& text_;
  const FmuSection& section_;
  const equations::Faults& faults_;
  bool sound_ = true;
  const ModelDescription* description_ = nullptr;
  FmuBlock block_;
  TextPlant frame_;
  std::vector<std::string> input_units_, parameter_units_;
  std::vector<bool> starts_by_fmu_;
  std::string undefined_units_;
  std::map<std::string, std::string> keys_;  ///< of the frame's rows, to those of the file
};

}  // namespace

std::optional<equations::BuiltPlant> build_fmu_plant(const TextPlant& text, const FmuSection& section,
                                                     const equations::Faults& faults) {
  return Builder(text, section, faults).build();
}

}  // namespace sealwatch::fmi
