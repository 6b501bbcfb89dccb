#include "services/common/fmi/model_description.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <set>

#include "sealwatch/core/text.hpp"
#include "sealwatch/core/visible_text.hpp"
#include "services/common/fmi/description_reader.hpp"

namespace sealwatch::fmi {
namespace {

constexpr std::size_t kMostStates = 2000;

std::optional<Interface> read_interface(const DescriptionReader& reader, const pugi::xml_node& node, bool fmi2) {
  if (!node) return std::nullopt;
  Interface result{.model_identifier = reader.required(node, "modelIdentifier"),
                   .needs_execution_tool = reader.flag(node, "needsExecutionTool"),
                   .once_per_process = reader.flag(node, "canBeInstantiatedOnlyOncePerProcess"),
                   .directional_derivatives = reader.flag(node, "providesDirectionalDerivative") ||
                                              reader.flag(node, "providesDirectionalDerivatives"),
                   .needs_completed_step = fmi2 ? !reader.flag(node, "completedIntegratorStepNotNeeded")
                                                : reader.flag(node, "needsCompletedIntegratorStep"),
                   .variable_steps = reader.flag(node, "canHandleVariableCommunicationStepSize"),
                   .fixed_step_s = reader.bound(node, "fixedInternalStepSize").value_or(0.0)};
  const std::string& name = result.model_identifier;
  const bool plain = !name.empty() &&
                     std::ranges::all_of(name, [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; }) &&
                     std::isdigit(static_cast<unsigned char>(name[0])) == 0;
  if (!plain) reader.refuse(node, name, "modelIdentifier must be a name of the C language");
  return result;
}

std::vector<Unit> read_units(const DescriptionReader& reader, const pugi::xml_node& root) {
  constexpr std::array kBase = {"kg", "m", "s", "A", "K", "mol", "cd", "rad"};
  std::vector<Unit> units;
  for (const pugi::xml_node& node : root.child("UnitDefinitions").children("Unit")) {
    Unit unit{.name = reader.required(node, "name")};
    if (const pugi::xml_node base = node.child("BaseUnit")) {
      unit.has_base = true;
      for (std::size_t k = 0; k < kBase.size(); ++k) {
        const double exponent = reader.number(base, kBase[k]).value_or(0.0);
        if (exponent != static_cast<int>(std::clamp(exponent, -99.0, 99.0)))
          reader.refuse(node, reader.text(base, kBase[k]), "an exponent must be a whole number");
        unit.exponents[k] = static_cast<int>(exponent);
      }
      unit.factor = reader.number(base, "factor").value_or(1.0);
      unit.offset = reader.number(base, "offset").value_or(0.0);
      if (unit.factor == 0.0) reader.refuse(node, "0", "the factor of a unit must not be 0");
    }
    units.push_back(std::move(unit));
  }
  return units;
}

void read_experiment(const DescriptionReader& reader, const pugi::xml_node& node, ModelDescription& description) {
  description.start_time_s = reader.bound(node, "startTime");
  description.stop_time_s = reader.bound(node, "stopTime");
  description.step_s = reader.bound(node, "stepSize");
}

void check(const DescriptionReader& reader, const pugi::xml_node& root, const ModelDescription& description) {
  if (!description.model_exchange && !description.co_simulation)
    reader.refuse(root, description.scheduled_execution ? "ScheduledExecution" : "",
                  "offers neither Model Exchange nor Co-Simulation",
                  "export it for Model Exchange (then a law can be added to its derivatives)");
  if (description.states.size() > kMostStates)
    reader.refuse(root, std::to_string(description.states.size()) + " states",
                  "has more than " + std::to_string(kMostStates) + " states");
  for (const Variable& variable : description.variables)
    if (variable.type == FmiType::clock && variable.causality == FmiCausality::input)
      reader.refuse(root, variable.name,
                    "is an input clock: sealwatch ticks none, and what it drives would stand still",
                    "export the model without clocks from outside");
}

/// The element of an array at indices such as "2,1", row by row; nothing where there is none.
std::optional<std::size_t> element_at(std::string_view indices, const std::vector<std::size_t>& extents) {
  std::size_t element = 0;
  const char* from = indices.data();
  const char* const end = from + indices.size();
  for (std::size_t k = 0; k < extents.size(); ++k) {
    std::size_t index = 0;
    const auto [behind, error] = std::from_chars(from, end, index);
    if (error != std::errc() || index < 1 || index > extents[k]) return std::nullopt;
    const bool last = k + 1 == extents.size();
    if (last ? behind != end : behind == end || *behind != ',') return std::nullopt;
    element = element * extents[k] + index - 1;
    from = behind + (last ? 0 : 1);
  }
  return extents.empty() ? std::nullopt : std::optional(element);
}

void name_units(ModelDescription& description) {
  std::set<std::string> names;
  for (const Variable& variable : description.variables) names.insert(variable.unit);
  for (const std::string& name : names) {
    const auto unit = std::ranges::find(description.units, name, &Unit::name);
    if (name.empty() || (unit != description.units.end() && unit->has_base)) continue;
    if (unit == description.units.end())
      description.units.push_back({.name = name, .by_name = unit_by_name(name)});
    else
      unit->by_name = unit_by_name(name);
  }
}

ModelDescription read_root(const DescriptionReader& reader, const pugi::xml_node& root, const Settings& settings) {
  if (!root) reader.refuse(root, {}, "has no element fmiModelDescription");
  ModelDescription description;
  description.file = reader.file();
  description.version_text = reader.required(root, "fmiVersion");
  const bool fmi2 = description.version_text.starts_with("2.");
  if (!fmi2 && !description.version_text.starts_with("3."))
    reader.refuse(root, description.version_text, "is not a version of FMI that sealwatch runs: 2.0 and 3.0",
                  "export the model as FMI 2.0 or 3.0");
  if (description.version_text.find('-') != std::string::npos)
    reader.refuse(root, description.version_text, "is a draft of FMI, whose functions are not those of the standard",
                  "export the model as FMI 2.0 or 3.0");
  description.version = fmi2 ? Version::fmi2 : Version::fmi3;
  description.model_name = reader.required(root, "modelName");
  description.token = reader.required(root, fmi2 ? "guid" : "instantiationToken");
  description.tool = reader.text(root, "generationTool");
  description.description = reader.words(root, "description");
  description.model_exchange = read_interface(reader, root.child("ModelExchange"), fmi2);
  description.co_simulation = read_interface(reader, root.child("CoSimulation"), fmi2);
  description.scheduled_execution = !root.child("ScheduledExecution").empty();
  description.units = read_units(reader, root);
  read_experiment(reader, root.child("DefaultExperiment"), description);
  fmi2 ? read_fmi2(reader, root, description) : read_fmi3(reader, root, description, settings);
  name_units(description);
  description.structure_is_empty = root.child("ModelStructure").first_child().empty();
  check(reader, root, description);
  return description;
}

}  // namespace

// Of eight bits and no UTF-8, whatever it says: Windows' own page is Latin-1 but for a few signs.
pugi::xml_encoding encoding_of(std::string_view text) {
  const bool latin = !is_valid_utf8(text) && text.find('\0') == std::string_view::npos;
  return latin ? pugi::encoding_latin1 : pugi::encoding_auto;
}

Result<ModelDescription> read_model_description(const std::string& file, std::string_view text,
                                                const Settings& settings) {
  pugi::xml_document document;
  const pugi::xml_parse_result parsed =
      document.load_buffer(text.data(), text.size(), pugi::parse_default, encoding_of(text));
  const DescriptionReader reader(file, text);
  try {
    if (!parsed) {
      const auto end = std::min(static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, parsed.offset)), text.size());
      return fail(Error{
          .file = file,
          .place = "modelDescription.xml, line " + std::to_string(1 + std::ranges::count(text.substr(0, end), '\n')),
          .value = {},
          .rule = std::string("is not XML: ") + parsed.description(),
          .advice = "export the FMU again with the tool that made it"});
    }
    return read_root(reader, document.child("fmiModelDescription"), settings);
  } catch (const Fault& fault) {
    return fail(fault.error);
  }
}

double ModelDescription::stop_time() const {
  constexpr double kShort_s = 1.0;  // as other tools take it: some units cannot do without one
  const double start_s = start_time_s.value_or(0.0);
  return stop_time_s && *stop_time_s > start_s ? *stop_time_s : start_s + kShort_s;
}

const Variable* ModelDescription::find(std::string_view variable) const {
  const auto found = std::ranges::find(variables, variable, &Variable::name);
  return found == variables.end() ? nullptr : &*found;
}

const Unit* ModelDescription::find_unit(std::string_view unit) const {
  const auto found = std::ranges::find(units, unit, &Unit::name);
  return found == units.end() ? nullptr : &*found;
}

std::optional<SiUnit> ModelDescription::si_unit_of(const Variable& variable) const {
  const Unit* unit = find_unit(variable.unit);
  if (unit == nullptr || !(unit->has_base || unit->by_name)) return std::nullopt;
  if (!unit->has_base)
    return SiUnit{unit->by_name->name,
                  {unit->by_name->conversion.factor, variable.relative ? 0.0 : unit->by_name->conversion.offset}};
  return SiUnit{si_name(*unit), {unit->factor, variable.relative ? 0.0 : unit->offset}};
}

std::string ModelDescription::name_of(const Element& element) const {
  const Variable& variable = variables[element.variable];
  if (variable.size == 1) return variable.name;
  std::size_t rest = element.element;
  std::vector<std::size_t> indices(variable.extents.size());
  for (std::size_t k = indices.size(); k-- > 0; rest /= variable.extents[k])
    indices[k] = rest % variable.extents[k] + 1;
  std::string name = variable.name + "[";
  for (std::size_t k = 0; k < indices.size(); ++k) name.append(k == 0 ? "" : ",").append(std::to_string(indices[k]));
  return name.append("]");
}

Result<Element> ModelDescription::find_element(std::string_view name) const {
  for (std::size_t k = 0; k < variables.size(); ++k) {
    const Variable& variable = variables[k];
    if (variable.size == 0) continue;
    if (variable.name == name && variable.size == 1) return Element{k, 0};
    if (variable.size == 1 || !name.starts_with(variable.name + "[") || !name.ends_with(']')) continue;
    std::string_view indices = name.substr(variable.name.size() + 1);
    indices.remove_suffix(1);
    if (const auto element = element_at(indices, variable.extents)) return Element{k, *element};
  }
  std::vector<std::string> names;
  for (std::size_t k = 0; k < variables.size(); ++k)
    if (variables[k].size > 0) names.push_back(name_of({k, 0}));
  return fail(Error{.file = file,
                    .place = {},
                    .value = std::string(name),
                    .rule = "is not a variable of the FMU",
                    .advice = suggest(name, names)});
}

}  // namespace sealwatch::fmi
