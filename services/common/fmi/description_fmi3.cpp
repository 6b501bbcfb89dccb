// FMI 3.0: one XML element a type; variables are named by their value references and may be arrays, whose sizes are
// numbers or the values of structural parameters.
#include <algorithm>
#include <charconv>
#include <unordered_map>

#include "services/common/fmi/description_reader.hpp"

namespace sealwatch::fmi {
namespace {

struct Kind {
  std::string_view element;
  FmiType type;
};
constexpr std::array kKinds = {
    Kind{"Float64", FmiType::float64}, Kind{"Float32", FmiType::float32}, Kind{"Int8", FmiType::int8},
    Kind{"UInt8", FmiType::uint8},     Kind{"Int16", FmiType::int16},     Kind{"UInt16", FmiType::uint16},
    Kind{"Int32", FmiType::int32},     Kind{"UInt32", FmiType::uint32},   Kind{"Int64", FmiType::int64},
    Kind{"UInt64", FmiType::uint64},   Kind{"Boolean", FmiType::boolean}, Kind{"Enumeration", FmiType::enumeration},
    Kind{"String", FmiType::string},   Kind{"Binary", FmiType::binary},   Kind{"Clock", FmiType::clock}};
constexpr std::uint64_t kMostElements = 1000000;

/// Value references to places among the variables.
using Places = std::unordered_map<std::uint32_t, std::size_t>;

std::uint32_t reference_of(const DescriptionReader& reader, const pugi::xml_node& node, const char* name) {
  return static_cast<std::uint32_t>(reader.whole(node, name, UINT32_MAX));
}

std::size_t place_of(const DescriptionReader& reader, const pugi::xml_node& node, const char* name,
                     const Places& places) {
  const auto place = places.find(reference_of(reader, node, name));
  if (place == places.end()) reader.refuse(node, reader.text(node, name), "is not a variable's value reference");
  return place->second;
}

void read_extents(const DescriptionReader& reader, const pugi::xml_node& node, const Places& places,
                  const ModelDescription& description, Variable& variable) {
  for (const pugi::xml_node& dimension : node.children("Dimension")) {
    std::uint64_t extent = 0;
    if (dimension.attribute("start")) {
      extent = reader.whole(dimension, "start", kMostElements);
    } else {
      const Variable& parameter = description.variables[place_of(reader, dimension, "valueReference", places)];
      if (parameter.start.size() != 1 || parameter.start[0] < 0.0 || parameter.start[0] > kMostElements)
        reader.refuse(dimension, parameter.name, "gives the size of an array and has no start value for it");
      extent = static_cast<std::uint64_t>(parameter.start[0]);
    }
    variable.extents.push_back(extent);
    variable.size *= extent;
    if (variable.size > kMostElements) reader.refuse(node, std::to_string(variable.size), "is too large an array");
  }
}

Variable read_variable(const DescriptionReader& reader, const pugi::xml_node& node, FmiType type,
                       const DeclaredTypes& types) {
  const bool real = type == FmiType::float64 || type == FmiType::float32;
  const FmiCausality causality = reader.one_of(node, "causality", FmiCausality::local);
  const bool parameter = causality == FmiCausality::parameter || causality == FmiCausality::structuralParameter;
  const FmiVariability usual = parameter ? FmiVariability::fixed
                               : real    ? FmiVariability::continuous
                                         : FmiVariability::discrete;
  Variable variable{.name = reader.required(node, "name"),
                    .reference = reference_of(reader, node, "valueReference"),
                    .type = type,
                    .causality = causality,
                    .variability = reader.one_of(node, "variability", usual),
                    .unit = {},
                    .description = reader.words(node, "description"),
                    .start = {},
                    .min = {},
                    .max = {},
                    .nominal = {},
                    .derivative_of = {}};
  variable.begins = node.child("Annotations").find_child_by_attribute("Annotation", "type", kBegins).text().get();
  read_number_attributes(reader, node, types, variable);
  return variable;
}

DeclaredTypes read_types(const DescriptionReader& reader, const pugi::xml_node& root) {
  DeclaredTypes types;
  for (const pugi::xml_node& type : root.child("TypeDefinitions").children())
    types[reader.required(type, "name")] = read_type(reader, type);
  return types;
}

bool has_structural_size(const pugi::xml_node& node) {
  const auto dimensions = node.children("Dimension");
  return std::any_of(dimensions.begin(), dimensions.end(),
                     [](const pugi::xml_node& dimension) { return !!dimension.attribute("valueReference"); });
}

/// Sizes and derivatives refer to variables that may come later.
void resolve(const DescriptionReader& reader, const std::vector<pugi::xml_node>& nodes, const Places& places,
             bool settings_change_sizes, ModelDescription& description) {
  std::uint64_t total = 0;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    Variable& variable = description.variables[k];
    read_extents(reader, nodes[k], places, description, variable);
    if ((total += variable.size) > kMostElements) reader.refuse(nodes[k], variable.name, "is one array too many");
    if (settings_change_sizes && has_structural_size(nodes[k])) variable.start.clear();
    if (variable.start.size() > 1 && variable.start.size() != variable.size)
      reader.refuse(nodes[k], std::to_string(variable.start.size()) + " values",
                    "start must have a value for each of the " + std::to_string(variable.size) + " elements");
    if (variable.start.size() == 1) variable.start.assign(variable.size, variable.start[0]);
    if (variable.size == 0) variable.start.clear();
    if (nodes[k].attribute("derivative")) variable.derivative_of = place_of(reader, nodes[k], "derivative", places);
  }
}

/// Structural parameters take the values that they are set to; whether any did.
bool set_structure(const Settings& settings, ModelDescription& description) {
  bool changed = false;
  for (Variable& variable : description.variables) {
    const auto setting = settings.find(variable.name);
    if (variable.causality != FmiCausality::structuralParameter || setting == settings.end()) continue;
    double value = 0.0;
    const std::string& text = setting->second;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) continue;  // refused where settings are checked
    variable.start = {value};
    changed = true;
  }
  return changed;
}

}  // namespace

void read_fmi3(const DescriptionReader& reader, const pugi::xml_node& root, ModelDescription& description,
               const Settings& settings) {
  const DeclaredTypes types = read_types(reader, root);
  Places places;
  std::vector<pugi::xml_node> nodes;
  for (const pugi::xml_node& node : root.child("ModelVariables").children()) {
    const auto kind = std::ranges::find(kKinds, std::string_view(node.name()), &Kind::element);
    if (kind == kKinds.end()) reader.refuse(node, node.name(), "is not a type of variable of the standard");
    description.variables.push_back(read_variable(reader, node, kind->type, types));
    nodes.push_back(node);
    if (!places.emplace(description.variables.back().reference, nodes.size() - 1).second)
      reader.refuse(node, std::to_string(description.variables.back().reference),
                    "is another variable's value reference");
  }
  resolve(reader, nodes, places, set_structure(settings, description), description);
  // Other names of a variable: to be read by, and no second input or parameter.
  for (std::size_t k = 0; k < nodes.size(); ++k)
    for (const pugi::xml_node& alias : nodes[k].children("Alias")) {
      Variable other = description.variables[k];
      other.name = reader.required(alias, "name");
      other.causality = FmiCausality::local;
      other.derivative_of.reset();
      description.variables.push_back(std::move(other));
    }
  const pugi::xml_node structure = root.child("ModelStructure");
  for (const pugi::xml_node& node : structure.children("ContinuousStateDerivative"))
    if (description.model_exchange)
      add_states(reader, node, place_of(reader, node, "valueReference", places), description);
  for (const char* list : {"ContinuousStateDerivative", "Output"})
    for (const pugi::xml_node& node : structure.children(list))
      read_dependencies(reader, node, place_of(reader, node, "valueReference", places), description,
                        [&](std::uint64_t reference) {
                          const auto at = places.find(static_cast<std::uint32_t>(reference));
                          return at != places.end() ? std::optional(at->second) : std::nullopt;
                        });
  for (const pugi::xml_node& node : structure.children("InitialUnknown"))
    for (const std::uint64_t reference : reader.wholes(node, "dependencies"))
      if (const auto place = places.find(static_cast<std::uint32_t>(reference)); place != places.end())
        description.start_links[place_of(reader, node, "valueReference", places)].push_back(place->second);
  for (const pugi::xml_node& node : structure.children("EventIndicator"))
    description.event_indicators += description.variables[place_of(reader, node, "valueReference", places)].size;
}

}  // namespace sealwatch::fmi
