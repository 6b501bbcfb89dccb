#include "services/common/fmi/export/law_code.hpp"

#include <algorithm>

#include "sealwatch/model/law_sizes.hpp"
#include "services/common/equations/site_table.hpp"
#include "services/common/fmi/export/law_formulas.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch::fmi {
namespace {

std::string name_of_function(const PhysicsTerm& term) {
  std::string name = term.element + "_" + term.id;
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

/// One argument of a law's function.
struct Argument {
  std::string formula_name;          ///< "s1", "p2", "h"
  std::string unit, meaning, value;  ///< value: "" of a signal
};

/// Of kind own, whose words are the plant's; null: of another kind.
const Site* own_site(const Law& law, const PhysicsTerm& term, const PlantDescription& plant) {
  const auto site = std::ranges::find_if(
      plant.sites, [&](const Site& one) { return one.element == term.element && one.kind == law.kind; });
  return law.kind == SiteKind::own && site != plant.sites.end() ? &*site : nullptr;
}

std::vector<Argument> signals_of(const Law& law, const Site* own) {
  std::vector<Argument> signals;
  const equations::SiteNames& known = equations::names_of_site(law.kind);
  for (std::size_t k = 0; k < kSiteSignals; ++k) {
    const std::string_view name = own == nullptr ? known.signals[k].name : own->signals[k].name;
    const std::string_view unit = own == nullptr ? known.signals[k].unit : own->signals[k].unit;
    if (!name.empty()) signals.push_back({"s" + std::to_string(k + 1), std::string(unit), std::string(name), ""});
  }
  return signals;
}

std::vector<Argument> arguments_of(const Law& law, const PhysicsTerm& term, const PlantDescription& plant) {
  std::vector<Argument> arguments = signals_of(law, own_site(law, term, plant));
  if (law.hidden)
    arguments.push_back({"h", std::string(law.hidden->unit), "hidden state: " + std::string(law.hidden->name), ""});
  for (std::size_t k = 0; k < law.parameters.size(); ++k) {
    const LawParameter& parameter = law.parameters[k];
    const auto setting = term.parameters.find(std::string(parameter.name));
    if (setting == term.parameters.end()) continue;
    arguments.push_back({"p" + std::to_string(k + 1), std::string(parameter.unit),
                         std::string(parameter.name) + ": " + in_sizes_of(plant, law, parameter.meaning),
                         text::exact(setting->second.value)});
  }
  const Roundings widths = roundings_of(plant, law);
  for (std::size_t k = 0; k < law.roundings.size(); ++k)
    arguments.push_back({"r" + std::to_string(k + 1), std::string(law.roundings[k].unit),
                         "width over which a corner is rounded", text::exact(widths[k])});
  return arguments;
}

std::string heading(const Law& law, const PhysicsTerm& term, const PlantDescription& plant) {
  const Site* own = own_site(law, term, plant);
  const std::string_view unit = own == nullptr ? equations::names_of_site(law.kind).unit : own->unit;
  return std::string(law.id) + " at " + term.element + ": " + in_sizes_of(plant, law, law.equation) + "\n" +
         std::string(law.meaning) + "; a loss counts positive, unit of the result: " + std::string(unit);
}

std::string with_line_starts(const std::string& text, const std::string& start) {
  std::string result = start;
  for (const char c : text) {
    result += c;
    if (c == '\n') result += start;
  }
  return result;
}

/// What the function of C is called with; its other arguments are constants that say it of themselves.
std::string words_of_arguments(const std::vector<Argument>& arguments) {
  std::string words;
  for (const Argument& argument : arguments)
    if (argument.value.empty())
      words += "\n  " + argument.formula_name + ": " + argument.meaning + " [" + argument.unit + "]";
  return words;
}

std::string c_function(const std::string& name, const std::vector<Argument>& arguments, std::string_view formula) {
  std::string text = "double " + name + "(";
  std::string defaults, separator;
  for (const Argument& argument : arguments) {
    if (argument.value.empty()) {
      text += separator + "double " + argument.formula_name;
      separator = ", ";
    } else {
      defaults += "  const double " + argument.formula_name + " = " + argument.value + "; /* " + argument.meaning +
                  " [" + argument.unit + "] */\n";
    }
  }
  return text + ") {\n" + defaults + "  return " + in_c(formula) + ";\n}\n";
}

std::string modelica_function(const std::string& name, const std::vector<Argument>& arguments,
                              std::string_view formula) {
  std::string text = "  function " + name + "\n";
  for (const Argument& argument : arguments)
    text += "    input Real " + argument.formula_name + (argument.value.empty() ? "" : " = " + argument.value) + " \"" +
            argument.meaning + " [" + argument.unit + "]\";\n";
  return text + "    output Real y;\n  algorithm\n    y := " + std::string(formula) + ";\n  end " + name + ";\n";
}

}  // namespace

LawCode law_code(const PlantDescription& plant, const AssetConfig& asset) {
  LawCode code{
      .c = "/* Physics that sealwatch found at " + asset.asset_id + " (plant " + plant.name +
           "), SI units.\n * s1, s2, ...: what the law sees; h: its hidden state, whose rate is a function of its "
           "own. */\n#include <math.h>\n\n" +
           helper_functions_c() + "\n",
      .modelica = "// Physics that sealwatch found at " + asset.asset_id + " (plant " + plant.name +
                  "), SI units.\npackage FoundPhysics\n" + helper_functions_modelica()};
  for (const PhysicsTerm& term : asset.physics) {
    std::vector<std::string> names;
    for (const auto& [name, setting] : term.parameters) names.push_back(name);
    const auto law = find_law(term.id, names, plant.name);
    const auto formula = law ? written(**law) : std::nullopt;
    if (!formula) {
      const std::string left_out =
          term.id + " at " + term.element + ": of a sensor or of the recording, not written here.";
      code.c += "/* " + left_out + " */\n";
      code.modelica += "  // " + left_out + "\n";
      continue;
    }
    const std::vector<Argument> arguments = arguments_of(**law, term, plant);
    const std::string function = name_of_function(term), head = heading(**law, term, plant);
    code.c += "/*\n" + with_line_starts(head + words_of_arguments(arguments), " * ") + "\n */\n" +
              c_function(function, arguments, formula->contribution) + "\n";
    code.modelica +=
        with_line_starts(head, "  // ") + "\n" + modelica_function(function, arguments, formula->contribution);
    if (formula->rate.empty()) continue;
    code.c += "/* d/dt of its hidden state h */\n" + c_function(function + "_rate", arguments, formula->rate) + "\n";
    code.modelica +=
        "  // d/dt of its hidden state h\n" + modelica_function(function + "_rate", arguments, formula->rate);
  }
  code.modelica += "end FoundPhysics;\n";
  return code;
}

}  // namespace sealwatch::fmi
