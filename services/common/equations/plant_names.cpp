#include "services/common/equations/plant_names.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>

#include "sealwatch/core/text.hpp"

namespace sealwatch::equations {
namespace {

Error fault(std::string value, std::string rule, std::string advice = {}) {
  return {.file = {}, .place = {}, .value = std::move(value), .rule = std::move(rule), .advice = std::move(advice)};
}

bool is_name(const std::string& text) {
  const auto letter = [](unsigned char c) { return std::isalpha(c) != 0 || c == '_'; };
  return !text.empty() && letter(static_cast<unsigned char>(text.front())) &&
         std::ranges::all_of(text, [&](unsigned char c) { return letter(c) || std::isdigit(c) != 0; });
}

}  // namespace

VariablePlaces::VariablePlaces(const TextPlant& plant)
    : states(1),
      inputs(states + plant.states.size()),
      rates(inputs + plant.inputs.size()),
      parameters(rates + plant.inputs.size()),
      added(parameters + plant.parameters.size()),
      count(added + plant.sites.size()) {}

PlantNames::PlantNames(const TextPlant& plant, Expressions& expressions, const Faults& faults)
    : plant_(plant), expressions_(expressions), faults_(faults), places_(plant) {
  known_["t"] = {expressions.variable(0), *find_dimension("s"), false};
  known_["pi"] = {expressions.constant(std::numbers::pi), Dimension{}, false};
  for (const char* name : {"t", "pi"}) taken_[name] = "the names that every plant has";
  for (std::size_t k = 0; k < plant.states.size(); ++k)
    add("states." + plant.states[k].description.name, plant.states[k].description.name,
        plant.states[k].description.unit, places_.states + k);
  for (std::size_t k = 0; k < plant.inputs.size(); ++k)
    add("inputs." + plant.inputs[k].channel.name, plant.inputs[k].channel.name, plant.inputs[k].channel.unit,
        places_.inputs + k);
  for (std::size_t k = 0; k < plant.parameters.size(); ++k)
    add("parameters." + plant.parameters[k].name, plant.parameters[k].name, plant.parameters[k].unit,
        places_.parameters + k);
  for (std::size_t k = 0; k < plant.sites.size(); ++k)
    if (!plant.sites[k].symbol.empty())
      add(plant.sites[k].key, plant.sites[k].symbol, plant.sites[k].unit, places_.added + k);
  for (const TextTable& table : plant.tables) add_table(table);
  for (const auto& [name, text] : plant.definitions) {
    add_name("definitions." + name, name);
    definitions_[name] = {text, std::nullopt, false};
  }
}

void PlantNames::add_name(const std::string& key, const std::string& name) {
  if (!is_name(name))
    faults_(key,
            fault(name, "is not a name for an equation", "letters, digits and _ make a name, a letter comes first"));
  const auto [known, added] = taken_.try_emplace(name, key);
  if (!added) faults_(key, fault(name, "is a name already, of " + known->second, "give one of them another name"));
  const std::vector<std::string> functions = known_functions();
  if (std::ranges::find(functions, name) != functions.end() || name == "rate")
    faults_(key, fault(name, "is the name of a function", "give it another name"));
}

void PlantNames::add(const std::string& key, const std::string& name, const std::string& unit, std::size_t variable) {
  add_name(key, name);
  const std::optional<Dimension> dimension = unit_at(key, unit);
  known_[name] = {expressions_.variable(variable), dimension.value_or(Dimension{}), !dimension};
}

void PlantNames::add_table(const TextTable& table) {
  const std::string key = "tables." + table.name;
  add_name(key, table.name);
  bool rising = table.x.size() >= 2 && table.x.size() == table.y.size();
  for (std::size_t k = 1; rising && k < table.x.size(); ++k) rising = table.x[k] > table.x[k - 1];
  if (!rising) {
    faults_(key, fault(table.name, "is not a table", "give two or more rising values of x and as many of y"));
    return;
  }
  tables_[table.name] = {expressions_.add_table(Table(table.x, table.y)), unit_at(key + ".x_unit", table.x_unit),
                         unit_at(key + ".y_unit", table.y_unit)};
}

std::optional<Dimension> PlantNames::unit_at(const std::string& key, const std::string& unit) {
  Result<Dimension> found = find_dimension(unit);
  if (!found) {
    faults_(key, found.error());
    return std::nullopt;
  }
  if (std::abs(found->scale - 1.0) > 1e-12)
    faults_(key, fault(unit, "is not the SI unit",
                       "give all in SI, here " + words_of(*found) +
                           "; recordings in other units are converted when they are read"));
  found->scale = 1.0;
  return *found;
}

void PlantNames::check_definitions() {
  for (const auto& [name, text] : plant_.definitions)
    if (!definitions_.at(name).meaning) define(name);
}

std::vector<std::string> PlantNames::names() const {
  std::vector<std::string> all;
  for (const auto& [name, formula] : known_) all.push_back(name);
  for (const auto& [name, definition] : definitions_) all.push_back(name);
  return all;
}

Result<Formula> PlantNames::quantity(const std::string& name) {
  if (const auto known = known_.find(name); known != known_.end()) return known->second;
  const auto definition = definitions_.find(name);
  if (definition == definitions_.end()) {
    const bool output = std::ranges::any_of(plant_.outputs, [&](const auto& row) { return row.channel.name == name; });
    if (output) return fail(fault(name, "is an output, which no equation may use", "use what it is computed from"));
    return fail(fault(name, "is not a known quantity", suggest(name, names())));
  }
  if (definition->second.open) {
    std::string circle;
    for (auto k = std::ranges::find(open_, name); k != open_.end(); ++k) circle += *k + " -> ";
    return fail(fault(name, "depends on itself: " + circle + name,
                      "an algebraic loop has no value of its own: solve it by hand, or make one of them a state"));
  }
  constexpr std::size_t kDeepest = 40;
  if (!definition->second.meaning && open_.size() >= kDeepest)
    return fail(fault(name, "is a definition within more than " + std::to_string(kDeepest) + " others",
                      "put some of them together"));
  if (!definition->second.meaning) define(name);
  return *definition->second.meaning;
}

void PlantNames::define(const std::string& name) {
  Definition& definition = definitions_.at(name);
  definition.open = true;
  open_.push_back(name);
  const Result<Formula> meaning = understand(definition.text, expressions_, *this);
  open_.pop_back();
  definition.open = false;
  if (!meaning) faults_("definitions." + name, meaning.error());
  definition.meaning = meaning.value_or(Formula{expressions_.constant(1.0), Dimension{}, true});
}

std::optional<Result<Formula>> PlantNames::call(const std::string& name, const std::vector<Syntax>& arguments) {
  if (name == "rate") {
    const auto input = std::ranges::find_if(plant_.inputs, [&](const TextInput& candidate) {
      return arguments.size() == 1 && arguments[0].kind == Syntax::Kind::name &&
             candidate.channel.name == arguments[0].text;
    });
    if (input == plant_.inputs.end())
      return fail(fault("rate", "takes the name of an input", "the rate of a state is its equation"));
    const auto k = static_cast<std::size_t>(input - plant_.inputs.begin());
    const Formula& of = known_.at(input->channel.name);
    return Formula{expressions_.variable(places_.rates + k), multiply(of.dimension, *find_dimension("s"), -1.0),
                   of.any_unit};
  }
  const auto table = tables_.find(name);
  if (table == tables_.end()) return std::nullopt;
  if (arguments.size() != 1) return fail(fault(name, "is a table and takes one argument"));
  const Result<Formula> at = understand(arguments[0], expressions_, *this);
  if (!at) return fail(at.error());
  const auto& [number, x, y] = table->second;
  if (x && !at->any_unit && !(at->dimension == *x))
    return fail(fault(name, "is a table over " + words_of(*x) + ", not over " + words_of(at->dimension)));
  return Formula{expressions_.table(number, at->node), y.value_or(Dimension{}), !y};
}

std::vector<std::string> PlantNames::functions() const {
  std::vector<std::string> all = {"rate"};
  for (const auto& [name, table] : tables_) all.push_back(name);
  return all;
}

}  // namespace sealwatch::equations
