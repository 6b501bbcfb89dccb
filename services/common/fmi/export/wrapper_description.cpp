#include "services/common/fmi/export/wrapper_description.hpp"

#include <array>
#include <fstream>
#include <iterator>
#include <map>
#include <pugixml.hpp>
#include <set>
#include <sstream>

#include "services/common/fmi/description_reader.hpp"
#include "services/common/fmi/export/c_expressions.hpp"
#include "services/common/fmi/export/laws_function.hpp"

namespace sealwatch::fmi {
namespace {

using pugi::xml_node;

void set(xml_node node, const char* name, const std::string& value) {
  if (!node.attribute(name)) node.append_attribute(name);
  node.attribute(name).set_value(value.c_str());
}

xml_node child_behind(xml_node parent, const char* name, const char* before) {
  if (xml_node child = parent.child(name)) return child;
  const xml_node other = parent.child(before);
  return other ? parent.insert_child_after(name, other) : parent.prepend_child(name);
}

class Rewriter {
 public:
  Rewriter(const FmuFile& inner, const WrapperVariables& own)
      : inner_(inner), own_(own), third_(inner.description().version == Version::fmi3) {}

  Result<std::string> write() {
    std::ifstream stream(inner_.unpacked().path_of(kDescriptionName), std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    pugi::xml_document document;
    if (!document.load_buffer(text.data(), text.size(), pugi::parse_full, encoding_of(text)))
      return fail(
          Error{.file = inner_.name(), .place = kDescriptionName, .value = {}, .rule = "is not XML", .advice = {}});
    root_ = document.child("fmiModelDescription");
    for (xml_node& node : variables_of(root_)) variables_.push_back(node);
    for (const xml_node& node : variables_) {
      names_.insert(node.attribute("name").value());
      for (const xml_node& alias : node.children("Alias")) names_.insert(alias.attribute("name").value());
    }
    head();
    units();
    change_variables();
    add_variables();
    if (xml_node declaration = document.first_child(); declaration.type() == pugi::node_declaration)
      set(declaration, "encoding", "UTF-8");  // whatever it was: save() writes that
    std::ostringstream out;
    document.save(out, "  ");
    return out.str();
  }

 private:
  // FMI 3.0 names a variable's element by its type, FMI 2.0 has an element of the type in it.
  [[nodiscard]] std::vector<xml_node> variables_of(const xml_node& root) const {
    std::vector<xml_node> variables;
    for (const xml_node& node : root.child("ModelVariables").children())
      if (third_ ? node.type() == pugi::node_element : std::string_view(node.name()) == "ScalarVariable")
        variables.push_back(node);
    return variables;
  }
  [[nodiscard]] xml_node typed(std::size_t place) const {
    return third_ ? variables_[place] : variables_[place].first_child();
  }
  void set_start(std::size_t place, const std::string& value) const {
    const bool text = third_ && std::string_view(variables_[place].name()) == "String";
    xml_node node = typed(place);
    if (text && !node.child("Start")) node.append_child("Start");
    set(text ? node.child("Start") : node, text ? "value" : "start", value);
  }

  // All of an array's, each as the description or an earlier call has it.
  void set_element_of_start(const ChangedStart& start, const Variable& variable) {
    std::vector<double>& values = array_starts_[start.variable];
    if (values.empty()) values = variable.start;
    values.resize(variable.size, 0.0);
    values[start.element] = start.value;
    std::string all;
    for (const double value : values) all += (all.empty() ? "" : " ") + c_number(value);
    set_start(start.variable, all);
  }

  void head() {
    set(root_, third_ ? "instantiationToken" : "guid", own_.token);
    set(root_, "modelName", std::string(root_.attribute("modelName").value()) + "_explained");
    const std::string tool = inner_.description().tool;
    set(root_, "generationTool", (tool.empty() ? "" : tool + ", ") + "laws added by sealwatch");
    for (const char* interface : {"CoSimulation", "ScheduledExecution"}) root_.remove_child(interface);
    xml_node exchange = root_.child("ModelExchange");
    set(exchange, "modelIdentifier", own_.identifier);
    for (const char* name :
         {"providesDirectionalDerivative", "canGetAndSetFMUstate", "canSerializeFMUstate",  // of FMI 2.0
          "providesDirectionalDerivatives", "providesAdjointDerivatives", "providesPerElementDependencies",
          "canGetAndSetFMUState", "canSerializeFMUState"})
      exchange.remove_attribute(name);
    if (third_) return;  // sources are described beside them
    exchange.remove_child("SourceFiles");
    exchange.prepend_child("SourceFiles").append_child("File").append_attribute("name").set_value("model.c");
  }

  void units() {
    for (const auto* list : {&own_.hidden, &own_.inputs, &own_.parameters, &own_.outputs})
      for (const OwnVariable& row : *list) {
        if (row.unit.empty()) continue;
        xml_node definitions = root_.child("UnitDefinitions");
        if (!definitions) definitions = root_.insert_child_after("UnitDefinitions", root_.child("ModelExchange"));
        if (definitions.find_child_by_attribute("Unit", "name", row.unit.c_str())) continue;
        xml_node unit = definitions.append_child("Unit");
        unit.append_attribute("name").set_value(row.unit.c_str());
        const auto powers = whole_powers(row.unit);
        xml_node base = powers ? unit.append_child("BaseUnit") : xml_node();
        for (const auto& [name, power] : powers.value_or(std::vector<std::pair<std::string, int>>()))
          base.append_attribute(name.c_str()).set_value(power);
      }
  }

  // Which sizes its arrays have is settled by the settings, and with others than the description's their starts are
  // known to the binary alone.
  void settle_structure() {
    for (std::size_t place = 0; place < variables_.size(); ++place) {
      const Variable& variable = inner_.description().variables[place];
      if (variable.start.empty() && variables_[place].child("Dimension")) variables_[place].remove_attribute("start");
      if (variable.causality != FmiCausality::structuralParameter) continue;
      set(variables_[place], "causality", "local");
      set(variables_[place], "variability", "constant");
    }
  }

  void change_variables() {
    settle_structure();
    for (const ChangedStart& start : own_.starts) {
      const Variable& variable = inner_.description().variables[start.variable];
      if (variable.size > 1)
        set_element_of_start(start, variable);
      else
        set_start(start.variable, c_number(start.value));
    }
    for (const std::size_t place : own_.settling) annotate(place, kSettles);
    for (const std::size_t place : own_.local_inputs) {
      set(variables_[place], "causality", "local");
      typed(place).remove_attribute("start");
    }
    for (const std::size_t place : own_.calculated) {
      set(variables_[place], "causality", "calculatedParameter");
      set(variables_[place], "initial", "calculated");
      typed(place).remove_attribute("start");
    }
    for (const auto& [name, text] : inner_.set_values()) {
      const auto place =
          static_cast<std::size_t>(inner_.description().find(name) - inner_.description().variables.data());
      set_start(place, text);
    }
  }

  // FMI 2.0 has annotations behind the type, FMI 3.0 before all else.
  void annotate(std::size_t place, const char* begins) {
    xml_node variable = variables_[place], notes = variable.child("Annotations");
    if (!notes) notes = third_ ? variable.prepend_child("Annotations") : variable.append_child("Annotations");
    xml_node note = notes.append_child(third_ ? "Annotation" : "Tool");
    note.append_attribute(third_ ? "type" : "name").set_value(kBegins);
    if (third_)
      note.text().set(begins);
    else
      note.append_attribute("start").set_value(begins);
  }

  // FMI 3.0: a name is one variable's, an alias's too.
  void remove_alias(const std::string& name) {
    for (xml_node& variable : variables_)
      if (variable.remove_child(variable.find_child_by_attribute("Alias", "name", name.c_str()))) names_.erase(name);
  }

  /// Returns its index, which counts from 1.
  std::size_t add(const OwnVariable& row, const char* causality, const char* variability, const char* initial,
                  bool with_start) {
    std::string name = row.name;
    if (row.takes_alias) remove_alias(name);
    while (!names_.insert(name).second) name += "_";
    xml_node variable = root_.child("ModelVariables").append_child(third_ ? "Float64" : "ScalarVariable");
    variable.append_attribute("name").set_value(name.c_str());
    variable.append_attribute("valueReference").set_value(row.reference);
    variable.append_attribute("description").set_value(row.meaning.c_str());
    variable.append_attribute("causality").set_value(causality);
    variable.append_attribute("variability").set_value(variability);
    if (initial != nullptr) variable.append_attribute("initial").set_value(initial);
    xml_node real = third_ ? variable : variable.append_child("Real");
    if (!row.unit.empty()) real.append_attribute("unit").set_value(row.unit.c_str());
    if (row.nominal > 0.0) real.append_attribute("nominal").set_value(c_number(row.nominal).c_str());
    if (with_start) real.append_attribute("start").set_value(c_number(row.start).c_str());
    variables_.push_back(variable);
    if (*row.begins != '\0') annotate(variables_.size() - 1, row.begins);
    return variables_.size();
  }

  // Unknowns stand in the order of their indices. What they depend on is no longer what the FMU says.
  static void add_unknown(xml_node list, std::size_t index) {
    xml_node next = list.first_child();
    while (next && next.attribute("index").as_ullong() < index) next = next.next_sibling();
    if (next && next.attribute("index").as_ullong() == index) return;
    xml_node unknown = next ? list.insert_child_before("Unknown", next) : list.append_child("Unknown");
    unknown.append_attribute("index").set_value(static_cast<unsigned long long>(index));
  }

  // FMI 3.0: one list of elements, of each kind together and in this order, which name variables by their references.
  void add_unknown3(xml_node structure, const std::string& kind, std::size_t place) const {
    constexpr std::array kOrder = {"Output", "ContinuousStateDerivative", "ClockedState", "InitialUnknown",
                                   "EventIndicator"};
    const std::string reference = variables_[place].attribute("valueReference").value();
    if (structure.find_child_by_attribute(kind.c_str(), "valueReference", reference.c_str())) return;
    xml_node last;
    for (const char* one : kOrder) {
      for (const xml_node& node : structure.children(one)) last = node;
      if (kind == one) break;
    }
    xml_node unknown = last ? structure.insert_child_after(kind.c_str(), last) : structure.prepend_child(kind.c_str());
    unknown.append_attribute("valueReference").set_value(reference.c_str());
  }

  void add_unknowns3(xml_node structure, const std::vector<std::size_t>& rates,
                     const std::vector<std::size_t>& outputs) const {
    for (const std::size_t index : outputs) add_unknown3(structure, "Output", index - 1);
    for (const std::size_t index : rates) add_unknown3(structure, "ContinuousStateDerivative", index - 1);
    for (const auto* list : {&rates, &outputs})
      for (const std::size_t index : *list) add_unknown3(structure, "InitialUnknown", index - 1);
    for (const std::size_t place : own_.calculated) add_unknown3(structure, "InitialUnknown", place);
  }

  static void forget_dependencies(xml_node unknown) {
    unknown.remove_attribute("dependencies"), unknown.remove_attribute("dependenciesKind");
  }

  void add_variables() {
    xml_node structure = root_.child("ModelStructure");
    for (xml_node& list : children(structure)) {
      forget_dependencies(list);
      for (xml_node& unknown : children(list)) forget_dependencies(unknown);
    }
    std::vector<std::size_t> states, rates, outputs;
    for (const OwnVariable& row : own_.hidden) states.push_back(add(row, "local", "continuous", "exact", true));
    for (std::size_t k = 0; k < own_.hidden_rates.size(); ++k) {
      rates.push_back(add(own_.hidden_rates[k], "local", "continuous", "calculated", false));
      typed(variables_.size() - 1)
          .append_attribute("derivative")
          .set_value(static_cast<unsigned long long>(third_ ? own_.hidden[k].reference : states[k]));
    }
    for (const OwnVariable& row : own_.inputs) add(row, "input", "continuous", nullptr, true);
    for (const OwnVariable& row : own_.parameters) add(row, "parameter", "tunable", "exact", true);
    for (const OwnVariable& row : own_.outputs)
      outputs.push_back(add(row, "output", "continuous", "calculated", false));
    if (third_) return add_unknowns3(structure, rates, outputs);
    if (!outputs.empty()) {
      xml_node list = structure.child("Outputs");
      if (!list) list = structure.prepend_child("Outputs");
      for (const std::size_t index : outputs) add_unknown(list, index);
    }
    if (!rates.empty()) {
      xml_node list = child_behind(structure, "Derivatives", "Outputs");
      for (const std::size_t index : rates)
        list.append_child("Unknown").append_attribute("index").set_value(static_cast<unsigned long long>(index));
    }
    xml_node initial = structure.child("InitialUnknowns");
    if (!initial) initial = structure.append_child("InitialUnknowns");
    for (const auto* list : {&rates, &outputs})
      for (const std::size_t index : *list) add_unknown(initial, index);
    for (const std::size_t place : own_.calculated) add_unknown(initial, place + 1);
    if (!initial.first_child()) structure.remove_child(initial);
  }

  static std::vector<xml_node> children(const xml_node& node) { return {node.begin(), node.end()}; }

  const FmuFile& inner_;
  const WrapperVariables& own_;
  bool third_;  ///< FMI 3.0
  xml_node root_;
  std::vector<xml_node> variables_;
  std::set<std::string> names_;
  std::map<std::size_t, std::vector<double>> array_starts_;
};

}  // namespace

Result<std::string> wrapper_description(const FmuFile& inner, const WrapperVariables& own) {
  return Rewriter(inner, own).write();
}

}  // namespace sealwatch::fmi
