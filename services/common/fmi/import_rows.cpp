#include "services/common/fmi/import_rows.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <string_view>
#include <utility>

namespace sealwatch::fmi {
namespace {

ImportRow row_of(const ModelDescription& fmu, const Element& element) {
  const Variable& variable = fmu.variables[element.variable];
  ImportRow row{
      .element = element, .name = {}, .channel = {}, .unit = "1", .scale = {}, .meaning = variable.description};
  if (const auto si = fmu.si_unit_of(variable)) row.unit = si->name, row.scale = si->conversion;
  if (row.meaning.empty()) row.meaning = fmu.name_of(element);
  if (variable.unit.empty() || row.unit == "1") row.meaning += variable.unit.empty() ? "" : " [" + variable.unit + "]";
  return row;
}

bool is_alias(const ModelDescription& fmu, const Element& output, const Element& state) {
  const Variable& variable = fmu.variables[output.variable];
  return fmu.variables[state.variable].reference == variable.reference && state.element == output.element &&
         variable.type == FmiType::float64;
}

}  // namespace

ImportRows import_rows(const FmuFile& file) {
  const ModelDescription& fmu = file.description();
  ImportRows out;
  if (!file.co_simulation())
    for (const Element& state : fmu.states) out.states.push_back(row_of(fmu, state));
  for (std::size_t k = 0; k < fmu.variables.size(); ++k) {
    const Variable& variable = fmu.variables[k];
    if (!is_number(variable.type)) continue;
    const bool real = variable.type == FmiType::float64 || variable.type == FmiType::float32;
    std::vector<ImportRow>* rows = nullptr;
    if (variable.causality == FmiCausality::input) rows = &out.inputs;
    if (variable.causality == FmiCausality::output) rows = &out.outputs;
    if (variable.causality == FmiCausality::parameter && real && variable.variability != FmiVariability::constant &&
        !file.settings().contains(variable.name))
      rows = &out.parameters;
    for (std::size_t element = 0; rows != nullptr && element < variable.size; ++element)
      rows->push_back(row_of(fmu, {k, element}));
  }
  for (ImportRow& output : out.outputs)
    for (std::size_t k = 0; k < out.states.size(); ++k)
      if (is_alias(fmu, output.element, out.states[k].element)) output.state = k, output.alias = true;
  return out;
}

Status check_names(const FmuFile& file, const ImportRows& rows) {
  const ModelDescription& fmu = file.description();
  std::map<std::string_view, int> count;
  for (const Variable& variable : fmu.variables) ++count[variable.name];
  for (const auto* group : {&rows.states, &rows.inputs, &rows.outputs, &rows.parameters})
    for (const ImportRow& row : *group)
      if (const std::string& name = fmu.variables[row.element.variable].name; count[name] > 1)
        return fail(import_refusal(file, name, "is the name of two variables",
                                   "give each a name of its own, and export again"));
  return {};
}

Error import_refusal(const FmuFile& file, std::string value, std::string rule, std::string advice) {
  return {.file = file.name(),
          .place = {},
          .value = std::move(value),
          .rule = std::move(rule),
          .advice = std::move(advice)};
}

std::string name_for(const std::string& name, std::initializer_list<std::set<std::string>*> taken) {
  static const std::
      set<std::string>
          kTaken = {"t",     "pi",   "sqrt", "exp",  "log",  "sin",  "cos",  "tan",  "asin",
                    "acos",  "atan", "tanh", "abs",  "min",  "max",  "sign", "step", "root",
                    "hypot", "rate", "mean", "time", "null", "Null", "NULL"};  // the last are no text in YAML
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

/// Quantities of expressions and recorded channels are two sets of names, to both of which inputs belong: a state and
// the channel that shows it may have one name. States come first.
void name_rows(const ModelDescription& fmu, ImportRows& rows) {
  std::set<std::string> quantities, channels;
  for (ImportRow& row : rows.states) row.name = name_for(fmu.name_of(row.element), {&quantities});
  for (ImportRow& row : rows.inputs) row.name = name_for(fmu.name_of(row.element), {&quantities, &channels});
  for (ImportRow& row : rows.outputs) {
    row.channel = name_for(fmu.name_of(row.element), {&channels});
    row.name = row.alias ? "" : name_for(fmu.name_of(row.element), {&quantities});
  }
  for (ImportRow& row : rows.parameters) row.name = name_for(fmu.name_of(row.element), {&quantities});
}

}  // namespace sealwatch::fmi
