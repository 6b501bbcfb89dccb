#include "services/common/fmi/export/export_model.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "sealwatch/core/rate_unit.hpp"
#include "sealwatch/core/text.hpp"
#include "services/common/equations/dimension.hpp"
#include "services/common/fmi/export/c_expressions.hpp"
#include "services/common/fmi/export/export_wrapper.hpp"
#include "services/common/fmi/export/law_formulas.hpp"
#include "services/common/fmi/export/laws_function.hpp"
#include "services/common/fmi/export/shell_text.hpp"
#include "services/common/fmi/export/wrapper_description.hpp"
#include "services/common/model/physics_terms.hpp"

namespace sealwatch::fmi {
namespace {

using equations::Node;

/// A variable of the exported FMU.
struct Row {
  std::string name, unit, meaning;
  double start = 0.0;
  double nominal = 0.0;     ///< 0: not said
  const char* begins = "";  ///< of a state: kSettles, kOwn
};

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '"')
      result += "&quot;";
    else
      result += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return result;
}

class Exporter {
 public:
  Exporter(const RuntimePlant& plant, const AssetConfig& asset, Version version)
      : plant_(plant), asset_(asset), version_(version) {}

  Result<ExportedModel> write() {
    const auto* text = dynamic_cast<const equations::TextEquations*>(plant_.equations.get());
    if (text == nullptr)
      return fail(Error{.file = plant_.description.file,
                        .place = {},
                        .value = plant_.description.name,
                        .rule = "is not written as text, so that its equations cannot be written in C",
                        .advice = "write it as text (docs/tutorial-plant.md)"});
    parts_ = text->parts();
    auto terms = resolve_physics(plant_.description, plant_.description.sites, asset_);
    if (!terms) return fail(terms.error());
    terms_ = std::move(*terms);
    parts_.signals.values = signals_seen(parts_, terms_, 0);
    if (const Status rows = collect(*text); !rows) return fail(rows.error());
    ExportedModel model{.version = version_,
                        .identifier = plant_.description.name,
                        .source = {},
                        .description = {},
                        .left_out = left_out(terms_),
                        .carried = {}};
    std::ranges::replace_if(
        model.identifier, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
    const auto equations = source();
    if (!equations) return fail(equations.error());
    token_ = "{sealwatch-" + content_hash(*equations) + "}";
    model.source = head() + *equations + std::string(version_ == Version::fmi3 ? fmi3_shell_text() : fmi2_shell_text());
    model.description = version_ == Version::fmi3 ? description3(model.identifier) : description(model.identifier);
    return model;
  }

 private:
  Status collect(const equations::TextEquations& text) {
    const PlantDescription& plant = plant_.description;
    TimeSeries nothing{.time_s = {0.0, 1.0}, .channels = {}};
    for (const ChannelDescription& channel : plant.channels)
      nothing.channels.push_back({channel.name, channel.unit, 0.0, {0.0, 0.0}});
    std::vector<double> values;
    for (const ParameterDescription& row : plant.parameters) {
      const auto setting = asset_.parameters.find(row.name);
      values.push_back(setting == asset_.parameters.end() ? row.value : setting->second.value);
      parameters_.push_back({row.name, row.unit, row.meaning, values.back()});
    }
    const auto start = text.initial_state(values, nothing);
    if (!start) return fail(start.error());
    for (std::size_t k = 0; k < plant.states.size(); ++k)
      states_.push_back({plant.states[k].name, plant.states[k].unit, plant.states[k].meaning, (*start)[k],
                         plant_.states[k].scale / equations::kErrorOfSize,
                         plant_.states[k].settles ? kSettles
                         : plant_.states[k].slow  ? kOwn
                                                  : ""});
    for (const ActiveTerm& term : terms_.active)  // in the order of their hidden states
      if (term.hidden >= 0)
        states_.push_back({terms_.hidden_names[static_cast<std::size_t>(term.hidden)],
                           std::string(term.law->hidden->unit), "hidden state of a law", 0.0,
                           terms_.hidden_scales[static_cast<std::size_t>(term.hidden)],
                           beginning_of(*term.law->hidden)});
    for (const PhysicsParameter& row : terms_.parameters)
      parameters_.push_back(
          {row.name, std::string(row.parameter->unit), std::string(row.parameter->meaning), row.setting.value});
    for (const RuntimeInput& input : plant_.inputs) {
      const ChannelDescription* channel = plant.find_channel(input.channel);
      inputs_.push_back({channel->name, channel->unit, channel->meaning, 0.0});
    }
    add_rates();
    for (const RuntimeOutput& output : plant_.outputs) {
      const ChannelDescription* channel = plant.find_channel(output.channel);
      outputs_.push_back({channel->name, channel->unit, channel->meaning, 0.0});
    }
    return {};
  }

  void add_rates() {
    std::vector<Node> all;
    for (const auto* nodes : {&parts_.derivatives.values, &parts_.signals.values, &parts_.outputs.values})
      all.insert(all.end(), nodes->begin(), nodes->end());
    const std::vector<bool> used = parts_.expressions.variables_of(all, parts_.places.count);
    const std::size_t plain = inputs_.size();
    for (std::size_t k = 0; k < plain; ++k) {
      const std::size_t input = parts_.used_inputs[k];
      if (!used[parts_.places.rates + input]) continue;
      rates_.push_back(input);
      inputs_.push_back({inputs_[k].name + "_rate", rate_unit(inputs_[k].unit), "rate of " + inputs_[k].name, 0.0});
    }
  }

  [[nodiscard]] std::string head() const {
    std::ostringstream out;
    out << "/* " << plant_.description.name << " of " << asset_.asset_id
        << ", written by sealwatch: the plant with the laws that were found. SI units. */\n"
        << "#define MODEL_TOKEN \"" << token_ << "\"\n"
        << "#define STATES " << states_.size() << "\n#define INPUTS " << inputs_.size() << "\n#define PARAMETERS "
        << parameters_.size() << "\n#define OUTPUTS " << outputs_.size()
        << "\n#include <math.h>\n#include <stddef.h>\n#include <string.h>\n\n";
    for (const auto& [name, rows] :
         {std::pair{"start_states", &states_}, {"start_inputs", &inputs_}, {"start_parameters", &parameters_}}) {
      out << "static const double " << name << "[] = {";
      for (const Row& row : *rows) out << c_number(row.start) << ", ";
      out << "0.0};\n";
    }
    out << "static const double nominal_states[] = {";
    for (const Row& row : states_) out << c_number(row.nominal) << ", ";
    out << "0.0};\n";
    return out.str() + "\n";
  }

  Result<std::string> source() {
    std::string text = c_tables(parts_.expressions);
    for (const auto& [name, nodes] : {std::pair{"plant_rates", &parts_.derivatives.values},
                                      {"plant_signals", &parts_.signals.values},
                                      {"plant_outputs", &parts_.outputs.values}})
      text += c_function(name, parts_, *nodes, rates_) + "\n";
    const auto laws = laws_function(
        plant_.description, terms_,
        {.head = "static void model_laws(double t, const double* x, const double* u, const double* p, double* e,\n"
                 "                       double* hidden_rates) {\n",
         .signals = "  plant_signals(t, x, u, p, e, s);\n",
         .end = "}\n",
         .first_site = 0,
         .signals_see_added = parts_.signals_see_added});
    if (!laws) return fail(laws.error());
    return text + helper_functions_c() + "\n" + *laws + R"c(
static void model_derivatives(double t, const double* x, const double* u, const double* p, double* dx) {
  double e[SITES + 1];
  model_laws(t, x, u, p, e, dx + PLANT_STATES);
  plant_rates(t, x, u, p, e, dx);
}
static void model_outputs(double t, const double* x, const double* u, const double* p, double* y) {
  double e[SITES + 1], hidden_rates[STATES + 1];
  model_laws(t, x, u, p, e, hidden_rates);
  plant_outputs(t, x, u, p, e, y);
}

)c" + partials();
  }

  /// Laws are known as functions alone: with one of them there are no exact derivatives.
  [[nodiscard]] bool has_partials() const { return terms_.active.empty(); }

  /// d (rates, outputs) / d (states, inputs), row by row.
  [[nodiscard]] std::string partials() {
    if (!has_partials()) return "";
    std::vector<std::size_t> variables;
    for (std::size_t k = 0; k < states_.size(); ++k) variables.push_back(parts_.places.states + k);
    for (const std::size_t input : parts_.used_inputs) variables.push_back(parts_.places.inputs + input);
    for (const std::size_t input : rates_) variables.push_back(parts_.places.rates + input);
    std::vector<Node> nodes;
    for (const auto* rows : {&parts_.derivatives.values, &parts_.outputs.values})
      for (const Node row : *rows)
        for (const std::size_t variable : variables) nodes.push_back(parts_.expressions.derivative(row, variable));
    return c_function("plant_partials", parts_, nodes, rates_) + R"c(
#define MODEL_PARTIALS
static int model_directional(double t, const double* x, const double* u, const double* p, const unsigned* unknowns,
                             size_t nu, const unsigned* knowns, size_t nk, const double* seed, double* sensitivity) {
  enum { kColumns = STATES + INPUTS };
  const double e[SITES + 1] = {0.0};
  double partials[(STATES + OUTPUTS) * kColumns + 1];
  size_t row, column;
  plant_partials(t, x, u, p, e, partials);
  for (row = 0; row < nu; ++row) {
    const size_t of = unknowns[row] / 1000U, index = unknowns[row] % 1000U;
    if (!(of == 2 && index < STATES) && !(of == 5 && index < OUTPUTS)) return 0;
    sensitivity[row] = 0.0;
    for (column = 0; column < nk; ++column) {
      const size_t by = knowns[column] / 1000U, place = knowns[column] % 1000U;
      if (!(by == 1 && place < STATES) && !(by == 3 && place < INPUTS)) return 0;
      sensitivity[row] +=
          seed[column] * partials[(of == 2 ? index : STATES + index) * kColumns + (by == 1 ? place : STATES + place)];
    }
  }
  return 1;
}
)c";
  }

  [[nodiscard]] std::string description(const std::string& identifier) const {
    std::ostringstream out;
    out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"2.0\" modelName=\""
        << escaped(plant_.description.name) << "\" guid=\"" << token_ << "\" description=\""
        << escaped(plant_.description.meaning) << "\" generationTool=\"sealwatch\" numberOfEventIndicators=\"0\">\n"
        << "<ModelExchange modelIdentifier=\"" << identifier << "\" completedIntegratorStepNotNeeded=\"true\""
        << (has_partials() ? " providesDirectionalDerivative=\"true\"" : "")
        << ">\n<SourceFiles><File name=\"model.c\"/></SourceFiles>\n"
           "</ModelExchange>\n";
    units(out);
    out << "<ModelVariables>\n";
    rows(out, states_, 1000, "causality=\"local\" variability=\"continuous\" initial=\"exact\"", true);
    for (std::size_t k = 0; k < states_.size(); ++k)
      out << "<ScalarVariable name=\"der(" << escaped(states_[k].name) << ")\" valueReference=\"" << 2000 + k
          << "\" causality=\"local\" variability=\"continuous\" initial=\"calculated\"><Real derivative=\"" << k + 1
          << "\"/></ScalarVariable>\n";
    rows(out, inputs_, 3000, "causality=\"input\" variability=\"continuous\"", true);
    rows(out, parameters_, 4000, "causality=\"parameter\" variability=\"tunable\" initial=\"exact\"", true);
    rows(out, outputs_, 5000, "causality=\"output\" variability=\"continuous\" initial=\"calculated\"", false);
    out << "</ModelVariables>\n<ModelStructure>\n";
    const std::size_t first = 2 * states_.size() + inputs_.size() + parameters_.size();
    const auto unknowns = [&](std::size_t from, std::size_t count) {
      for (std::size_t k = 0; k < count; ++k) out << "<Unknown index=\"" << from + k + 1 << "\"/>";
    };
    out << "<Outputs>", unknowns(first, outputs_.size()), out << "</Outputs>\n";
    if (!states_.empty()) out << "<Derivatives>", unknowns(states_.size(), states_.size()), out << "</Derivatives>\n";
    out << "<InitialUnknowns>", unknowns(states_.size(), states_.size()), unknowns(first, outputs_.size()),
        out << "</InitialUnknowns>\n</ModelStructure>\n</fmiModelDescription>\n";
    return out.str();
  }

  // FMI 3.0: variables are elements of their type, which others name by their value references.
  [[nodiscard]] std::string description3(const std::string& identifier) const {
    std::ostringstream out;
    out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"3.0\" modelName=\""
        << escaped(plant_.description.name) << "\" instantiationToken=\"" << token_ << "\" description=\""
        << escaped(plant_.description.meaning) << "\" generationTool=\"sealwatch\">\n<ModelExchange modelIdentifier=\""
        << identifier << (has_partials() ? "\" providesDirectionalDerivatives=\"true" : "") << "\"/>\n";
    units(out);
    out << "<ModelVariables>\n<Float64 name=\"time\" valueReference=\"0\" causality=\"independent\" "
           "variability=\"continuous\" unit=\"s\"/>\n";
    rows3(out, states_, 1000, "causality=\"local\" variability=\"continuous\" initial=\"exact\"", true);
    for (std::size_t k = 0; k < states_.size(); ++k)
      out << "<Float64 name=\"der(" << escaped(states_[k].name) << ")\" valueReference=\"" << 2000 + k
          << "\" causality=\"local\" variability=\"continuous\" initial=\"calculated\" derivative=\"" << 1000 + k
          << "\"/>\n";
    rows3(out, inputs_, 3000, "causality=\"input\" variability=\"continuous\"", true);
    rows3(out, parameters_, 4000, "causality=\"parameter\" variability=\"tunable\" initial=\"exact\"", true);
    rows3(out, outputs_, 5000, "causality=\"output\" variability=\"continuous\" initial=\"calculated\"", false);
    out << "</ModelVariables>\n<ModelStructure>\n";
    const auto unknowns = [&](const char* element, std::size_t from, std::size_t count) {
      for (std::size_t k = 0; k < count; ++k) out << "<" << element << " valueReference=\"" << from + k << "\"/>";
    };
    unknowns("Output", 5000, outputs_.size()), unknowns("ContinuousStateDerivative", 2000, states_.size());
    unknowns("InitialUnknown", 2000, states_.size()), unknowns("InitialUnknown", 5000, outputs_.size());
    out << "\n</ModelStructure>\n</fmiModelDescription>\n";
    return out.str();
  }

  static void rows3(std::ostringstream& out, const std::vector<Row>& list, std::size_t reference,
                    const char* attributes, bool with_start) {
    for (std::size_t k = 0; k < list.size(); ++k) {
      out << "<Float64 name=\"" << escaped(list[k].name) << "\" valueReference=\"" << reference + k
          << "\" description=\"" << escaped(list[k].meaning) << "\" " << attributes << " unit=\""
          << escaped(list[k].unit) << "\"";
      if (list[k].nominal > 0.0) out << " nominal=\"" << c_number(list[k].nominal) << "\"";
      if (with_start) out << " start=\"" << c_number(list[k].start) << "\"";
      if (*list[k].begins == '\0')
        out << "/>\n";
      else
        out << "><Annotations><Annotation type=\"" << kBegins << "\">" << list[k].begins
            << "</Annotation></Annotations></Float64>\n";
    }
  }

  // Units whose powers are whole; others are named without their meaning.
  void units(std::ostringstream& out) const {
    std::vector<std::string> names;
    if (version_ == Version::fmi3) names.emplace_back("s");  // of time
    for (const auto* list : {&states_, &inputs_, &parameters_, &outputs_})
      for (const Row& row : *list)
        if (std::ranges::find(names, row.unit) == names.end()) names.push_back(row.unit);
    out << "<UnitDefinitions>\n";
    for (const std::string& name : names) {
      out << "<Unit name=\"" << escaped(name) << "\">";
      if (const auto powers = whole_powers(name)) {
        out << "<BaseUnit";
        for (const auto& [base, power] : *powers) out << " " << base << "=\"" << power << "\"";
        out << "/>";
      }
      out << "</Unit>\n";
    }
    out << "</UnitDefinitions>\n";
  }

  static void rows(std::ostringstream& out, const std::vector<Row>& list, int reference, const char* attributes,
                   bool with_start) {
    for (std::size_t k = 0; k < list.size(); ++k) {
      out << "<ScalarVariable name=\"" << escaped(list[k].name) << "\" valueReference=\""
          << static_cast<std::size_t>(reference) + k << "\" description=\"" << escaped(list[k].meaning) << "\" "
          << attributes << "><Real unit=\"" << escaped(list[k].unit) << "\"";
      if (list[k].nominal > 0.0) out << " nominal=\"" << c_number(list[k].nominal) << "\"";
      if (with_start) out << " start=\"" << c_number(list[k].start) << "\"";
      out << "/>";
      if (*list[k].begins != '\0')
        out << "<Annotations><Tool name=\"" << kBegins << "\" start=\"" << list[k].begins << "\"/></Annotations>";
      out << "</ScalarVariable>\n";
    }
  }

  const RuntimePlant& plant_;
  const AssetConfig& asset_;
  Version version_;
  equations::TextEquationsParts parts_;  ///< its signals: those that laws in force see
  PhysicsTerms terms_;
  std::vector<Row> states_, inputs_, parameters_, outputs_;
  std::vector<std::size_t> rates_;
  std::string token_;
};

}  // namespace

Result<ExportedModel> export_model(const RuntimePlant& plant, const AssetConfig& asset,
                                   std::optional<Version> version) {
  const auto* unit = dynamic_cast<const FmuEquations*>(plant.equations.get());
  if (unit == nullptr) return Exporter(plant, asset, version.value_or(Version::fmi2)).write();
  const Version imported = unit->block().file->description().version;
  if (version && *version != imported)
    return fail(Error{.file = plant.description.file,
                      .place = {},
                      .value = plant.description.name,
                      .rule = std::string("has an imported FMU of FMI ") + (imported == Version::fmi3 ? "3.0" : "2.0") +
                              ", which is handed back by that version alone",
                      .advice = "leave out --fmi"});
  return export_wrapper(plant, *unit, asset);
}

}  // namespace sealwatch::fmi
