// FMI 2.0: variables are numbered by their place, from 1; the structure refers to these numbers.
#include "services/common/fmi/description_reader.hpp"

namespace sealwatch::fmi {
namespace {

struct Kind {
  const char* element;
  FmiType type;
};
constexpr std::array kKinds = {Kind{"Real", FmiType::float64}, Kind{"Integer", FmiType::int32},
                               Kind{"Boolean", FmiType::boolean}, Kind{"String", FmiType::string},
                               Kind{"Enumeration", FmiType::enumeration}};

DeclaredTypes read_types(const DescriptionReader& reader, const pugi::xml_node& root) {
  DeclaredTypes types;
  for (const pugi::xml_node& type : root.child("TypeDefinitions").children("SimpleType"))
    types[reader.required(type, "name")] = read_type(reader, type.first_child());
  return types;
}

Variable read_variable(const DescriptionReader& reader, const pugi::xml_node& node, const DeclaredTypes& types,
                       std::size_t count) {
  Variable variable{.name = reader.required(node, "name"),
                    .reference = static_cast<std::uint32_t>(reader.whole(node, "valueReference", UINT32_MAX)),
                    .causality = reader.one_of(node, "causality", FmiCausality::local),
                    .variability = reader.one_of(node, "variability", FmiVariability::continuous),
                    .unit = {},
                    .description = reader.words(node, "description"),
                    .start = {},
                    .min = {},
                    .max = {},
                    .nominal = {},
                    .derivative_of = {}};
  variable.begins = reader.text(node.child("Annotations").find_child_by_attribute("Tool", "name", kBegins), "start");
  for (const Kind& kind : kKinds) {
    const pugi::xml_node content = node.child(kind.element);
    if (!content) continue;
    variable.type = kind.type;
    read_number_attributes(reader, content, types, variable);
    if (variable.start.size() > 1) reader.refuse(node, reader.text(content, "start"), "start must be one number");
    if (kind.type != FmiType::float64 && !node.attribute("variability"))
      variable.variability = FmiVariability::discrete;
    if (content.attribute("derivative")) variable.derivative_of = reader.whole(content, "derivative", count) - 1;
    if (variable.derivative_of && *variable.derivative_of >= count)
      reader.refuse(node, "0", "derivative counts variables from 1");
    return variable;
  }
  reader.refuse(node, variable.name, "has no type: Real, Integer, Boolean, String or Enumeration");
}

}  // namespace

void read_fmi2(const DescriptionReader& reader, const pugi::xml_node& root, ModelDescription& description) {
  const DeclaredTypes types = read_types(reader, root);
  const pugi::xml_node variables = root.child("ModelVariables");
  std::size_t count = 0;
  for (const pugi::xml_node& node : variables.children("ScalarVariable")) count += node.empty() ? 0U : 1U;
  for (const pugi::xml_node& node : variables.children("ScalarVariable"))
    description.variables.push_back(read_variable(reader, node, types, count));
  const pugi::xml_node structure = root.child("ModelStructure");
  const auto place = [&](const pugi::xml_node& node) {
    const std::uint64_t index = reader.whole(node, "index", count);
    if (index == 0) reader.refuse(node, "0", "index counts variables from 1");
    return static_cast<std::size_t>(index - 1);
  };
  // A unit for Co-Simulation keeps its states to itself, whatever it tells of them.
  for (const pugi::xml_node& node : structure.child("Derivatives").children("Unknown"))
    if (description.model_exchange) add_states(reader, node, place(node), description);
  for (const char* list : {"Derivatives", "Outputs"})
    for (const pugi::xml_node& node : structure.child(list).children("Unknown"))
      read_dependencies(reader, node, place(node), description, [&](std::uint64_t index) {
        return index >= 1 && index <= count ? std::optional<std::size_t>(index - 1) : std::nullopt;
      });
  for (const pugi::xml_node& node : structure.child("InitialUnknowns").children("Unknown"))
    for (const std::uint64_t index : reader.wholes(node, "dependencies"))
      if (index >= 1 && index <= count) description.start_links[place(node)].push_back(index - 1);
  if (root.attribute("numberOfEventIndicators"))
    description.event_indicators = reader.whole(root, "numberOfEventIndicators", 1000000);
}

}  // namespace sealwatch::fmi
