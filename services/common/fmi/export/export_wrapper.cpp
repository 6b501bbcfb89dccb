#include "services/common/fmi/export/export_wrapper.hpp"

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "sealwatch/core/rate_unit.hpp"
#include "sealwatch/core/text.hpp"
#include "services/common/fmi/export/c_expressions.hpp"
#include "services/common/fmi/export/law_formulas.hpp"
#include "services/common/fmi/export/laws_function.hpp"
#include "services/common/fmi/export/shell_text.hpp"
#include "services/common/fmi/export/wrapper_description.hpp"
#include "services/common/fmi/export/wrapper_ports.hpp"

namespace sealwatch::fmi {
namespace {

using equations::Node;

class WrapperExporter {
 public:
  WrapperExporter(const RuntimePlant& plant, const FmuEquations& unit, const AssetConfig& asset)
      : plant_(plant),
        unit_(unit),
        asset_(asset),
        block_(unit.block()),
        parts_(dynamic_cast<const equations::TextEquations&>(unit.frame()).parts()) {}

  Result<ExportedModel> write() {
    const ModelDescription& inner = block_.file->description();
    if (block_.setup.co_simulation != 0)
      return refuse("is run for Co-Simulation, where no law can be added to a derivative",
                    std::string(inner.offers_exchange ? "take `interface: me` in its plant file"
                                                      : "export the model for Model Exchange from its tool") +
                        "; laws.c and laws.mo have the laws");
    auto terms = resolve_physics(plant_.description, plant_.description.sites, asset_);
    if (!terms) return fail(terms.error());
    terms_ = std::move(*terms);
    parts_.signals.values = signals_seen(parts_, terms_, block_.states.size() + block_.variables.size());
    auto ports = wrapper_ports(unit_, parts_);
    if (!ports) return fail(ports.error());
    ports_ = std::move(*ports);
    collect();
    for (const std::size_t input : description_.local_inputs)
      if (!changes_between_events(inner.variables[input]))
        return refuse(
            "has an input that changes at events alone and shares its channel: " + inner.variables[input].name,
            "give it a channel of its own in the plant file");
    const auto equations = source();
    if (!equations) return fail(equations.error());
    description_.token = "{sealwatch-" + content_hash(*equations + inner.token) + "}";
    description_.identifier = inner.model_exchange->model_identifier + "_explained";
    auto description = wrapper_description(*block_.file, description_);
    if (!description) return fail(description.error());
    const std::string functions{inner.version == Version::fmi3 ? fmi3_wrapper_text() : std::string_view()};
    return ExportedModel{.version = inner.version,
                         .identifier = description_.identifier,
                         .source = head() + *equations + std::string(fmi2_wrapper_text()) + functions,
                         .description = std::move(*description),
                         .left_out = left_out(terms_),
                         .carried = block_.file->name()};
  }

 private:
  [[nodiscard]] tl::unexpected<Error> refuse(std::string rule, std::string advice) const {
    return fail(Error{.file = block_.file->name(),
                      .place = {},
                      .value = plant_.description.name,
                      .rule = std::move(rule),
                      .advice = std::move(advice)});
  }

  // References of what the other unit does not have, in the order in which fmi2_wrapper.c numbers them.
  void collect() {
    std::uint32_t next = ports_.own;
    const auto add = [&](std::vector<OwnVariable>& list, OwnVariable row) {
      row.reference = next++;
      list.push_back(std::move(row));
    };
    for (const ActiveTerm& term : terms_.active)
      if (term.hidden >= 0)
        add(description_.hidden, {.name = terms_.hidden_names[static_cast<std::size_t>(term.hidden)],
                                  .unit = std::string(term.law->hidden->unit),
                                  .meaning = "hidden state of a law",
                                  .nominal = terms_.hidden_scales[static_cast<std::size_t>(term.hidden)],
                                  .begins = beginning_of(*term.law->hidden)});
    for (const OwnVariable& hidden : std::vector(description_.hidden))
      add(description_.hidden_rates, {"der(" + hidden.name + ")", "", "rate of a law's hidden state"});
    const std::vector<Element>& states = block_.file->description().states;
    for (std::size_t k = 0; k < states.size(); ++k)
      if (plant_.states[k].settles) add_once(description_.settling, states[k].variable);
    collect_channels(next);
    collect_parameters(next);
    for (std::size_t k = 0; k < ports_.shown.size(); ++k) {
      const ChannelDescription* channel = plant_.description.find_channel(plant_.outputs[k].channel);
      const std::optional<std::size_t> shown = ports_.shown[k];
      const Variable* same = shown ? block_.file->description().find(channel->name) : nullptr;
      if (shown && block_.file->description().variables[*shown].causality == FmiCausality::output) continue;
      if (same != nullptr && same->causality == FmiCausality::output) continue;
      // What runs the unit looks for the plant's channel: an alias that is the same gives its name up for it.
      const bool alias = same != nullptr && shown && block_.file->description().version == Version::fmi3 &&
                         block_.file->description().variables[*shown].reference == same->reference;
      add(description_.outputs,
          {.name = channel->name, .unit = channel->unit, .meaning = channel->meaning, .takes_alias = alias});
      outputs_.push_back(parts_.outputs.values[k]);
    }
    for (const DrivenVariable& input : ports_.inputs)
      if (!is_kept(channels_, input)) add_once(description_.local_inputs, input.variable);
    for (const DrivenVariable& parameter : ports_.parameters)
      if (!is_kept(values_, parameter)) add_once(description_.calculated, parameter.variable);
  }

  static void add_once(std::vector<std::size_t>& list, std::size_t one) {
    if (std::ranges::find(list, one) == list.end()) list.push_back(one);
  }

  /// Whether the variable itself brings a value of the plant.
  static bool is_kept(const std::vector<WrapperPort>& ports, const DrivenVariable& variable) {
    return std::ranges::any_of(ports, [&](const WrapperPort& port) {
      return port.reference == variable.port.reference && port.element == variable.port.element;
    });
  }

  /// The FMU's input that is this input of the plant; one that changes at events alone before others, which can follow.
  [[nodiscard]] const DrivenVariable* input_of(std::size_t plants) const {
    const DrivenVariable* found = nullptr;
    for (const DrivenVariable& input : ports_.inputs)
      if (input.alone == plants && (found == nullptr || !input.port.continuous)) found = &input;
    return found;
  }

  void collect_channels(std::uint32_t& next) {
    for (std::size_t k = 0; k < parts_.used_inputs.size(); ++k) {
      const DrivenVariable* same = input_of(parts_.used_inputs[k]);
      const std::uint32_t reference = next++;
      if (same != nullptr) {
        const Variable& variable = block_.file->description().variables[same->variable];
        channels_.push_back(same->port);
        channel_starts_.push_back(
            same->port.unit.to_si(variable.start.empty() ? 0.0 : variable.start[same->port.element]));
        continue;
      }
      const ChannelDescription* channel = plant_.description.find_channel(plant_.inputs[k].channel);
      channels_.push_back({.reference = reference, .unit = {}});
      channel_starts_.push_back(0.0);
      description_.inputs.push_back({channel->name, channel->unit, channel->meaning, 0.0, reference});
    }
    std::vector<Node> all;
    for (const auto* nodes : {&parts_.derivatives.values, &parts_.signals.values, &parts_.outputs.values})
      all.insert(all.end(), nodes->begin(), nodes->end());
    const std::vector<bool> used = parts_.expressions.variables_of(all, parts_.places.count);
    for (std::size_t k = 0; k < parts_.used_inputs.size(); ++k) {
      if (!used[parts_.places.rates + parts_.used_inputs[k]]) continue;
      const ChannelDescription* channel = plant_.description.find_channel(plant_.inputs[k].channel);
      rates_.push_back(parts_.used_inputs[k]);
      channels_.push_back({.reference = next, .unit = {}});
      channel_starts_.push_back(0.0);
      description_.inputs.push_back(
          {channel->name + "_rate", rate_unit(channel->unit), "rate of " + channel->name, 0.0, next++});
    }
  }

  void collect_parameters(std::uint32_t& next) {
    const auto own = [&](const std::string& name, const std::string& unit, const std::string& meaning, double value) {
      values_.push_back({.reference = next, .unit = {}});
      description_.parameters.push_back({name, unit, meaning, value, next});
    };
    for (std::size_t k = 0; k < plant_.description.parameters.size(); ++k, ++next) {
      const ParameterDescription& row = plant_.description.parameters[k];
      const auto setting = asset_.parameters.find(row.name);
      value_starts_.push_back(setting == asset_.parameters.end() ? row.value : setting->second.value);
      const auto same = std::ranges::find(ports_.parameters, std::optional(k), &DrivenVariable::alone);
      if (same == ports_.parameters.end()) {
        own(row.name, row.unit, row.meaning, value_starts_.back());
        continue;
      }
      values_.push_back(same->port);
      description_.starts.push_back(
          {same->variable, same->port.element, same->port.unit.from_si(value_starts_.back())});
    }
    for (const PhysicsParameter& row : terms_.parameters) {
      value_starts_.push_back(row.setting.value);
      own(row.name, std::string(row.parameter->unit), std::string(row.parameter->meaning), row.setting.value);
      ++next;
    }
  }

  [[nodiscard]] static std::string table(const char* name, const std::vector<WrapperPort>& ports) {
    std::ostringstream out;
    out << "static const Port " << name << "[] = {";
    for (const WrapperPort& port : ports) out << in_c(port) << ", ";
    out << in_c({}) << "};\n";
    return out.str();
  }
  [[nodiscard]] static std::string in_c(const WrapperPort& port) {
    std::ostringstream out;
    out << "{" << port.reference << "u, " << port.type << ", " << port.continuous << ", " << c_number(port.unit.factor)
        << ", " << c_number(port.unit.offset) << ", " << port.element << ", " << port.size << "}";
    return out.str();
  }
  [[nodiscard]] static std::string table(const char* name, const std::vector<double>& values) {
    std::ostringstream out;
    out << "static const double " << name << "[] = {";
    for (const double value : values) out << c_number(value) << ", ";
    out << "0.0};\n";
    return out.str();
  }

  /// Those that follow from the plant's values, and their expressions.
  [[nodiscard]] std::vector<const DrivenVariable*> following(bool inputs) const {
    std::vector<const DrivenVariable*> result;
    for (const DrivenVariable& variable : inputs ? ports_.inputs : ports_.parameters) {
      const bool kept = is_kept(inputs ? channels_ : values_, variable);
      if (inputs ? variable.port.continuous : !kept) result.push_back(&variable);
    }
    return result;
  }

  // Structural parameters come first. A text is written with every letter as a number, whatever it contains.
  [[nodiscard]] std::string settings() const {
    std::ostringstream out;
    std::size_t count = 0, structural = 0;
    out << "static const Setting settings[] = {";
    const auto write = [&](const Variable& variable, std::size_t element, double value, const std::string& text) {
      const WrapperPort port{.reference = variable.reference,
                             .type = type_in_c(variable.type, block_.file->description().version),
                             .unit = {},
                             .element = static_cast<std::uint32_t>(element),
                             .size = static_cast<std::uint32_t>(variable.size)};
      out << "{" << in_c(port) << ", " << c_number(value) << ", \"" << std::oct;
      for (const char letter : text) out << "\\" << static_cast<int>(static_cast<unsigned char>(letter)) << "\" \"";
      out << std::dec << "\"}, ";
      ++count;
    };
    for (const bool first : {true, false}) {
      for (const auto& [name, text] : block_.file->set_values()) {
        const Variable& variable = *block_.file->description().find(name);
        if ((variable.causality == FmiCausality::structuralParameter) != first) continue;
        if (variable.type == FmiType::string) {
          write(variable, 0, 0.0, text);
          continue;
        }
        std::istringstream words(text);
        std::string word;
        for (std::size_t k = 0; words >> word; ++k)
          write(variable, k, word == "true" ? 1.0 : std::strtod(word.c_str(), nullptr), "");
      }
      if (first) structural = count;
    }
    out << "{" << in_c({}) << ", 0.0, NULL}};\n#define SETTINGS " << count << "\n#define STRUCTURAL " << structural
        << "\n";
    return out.str();
  }

  // Of the arrays that can be set, all values: an array is set whole.
  [[nodiscard]] std::string arrays() const {
    std::ostringstream out;
    std::vector<double> starts;
    std::size_t largest = 1;
    out << "static const Array arrays[] = {";
    for (const Variable& variable : block_.file->description().variables) {
      if (variable.size == 1 || !is_number(variable.type)) continue;
      largest = std::max(largest, variable.size);
      const bool is_set = variable.causality == FmiCausality::input || variable.causality == FmiCausality::parameter;
      out << "{" << variable.reference << "u, " << variable.size << ", "
          << (is_set ? std::to_string(starts.size()) : "-1") << "}, ";
      for (std::size_t k = 0; is_set && k < variable.size; ++k)
        starts.push_back(variable.start.empty() ? 0.0 : variable.start[k]);
    }
    out << "{0u, -1, -1}};\n"
        << table("start_arrays", starts) << "#define IN_ARRAYS " << starts.size() << "\n#define LARGEST " << largest
        << "\n";
    return out.str();
  }

  [[nodiscard]] std::string head() const {
    std::ostringstream out;
    const ModelDescription& inner = block_.file->description();
    std::vector<WrapperPort> inputs, calculated;
    for (const DrivenVariable* one : following(true)) inputs.push_back(one->port);
    for (const DrivenVariable* one : following(false)) calculated.push_back(one->port);
    out << "/* " << plant_.description.name << " of " << asset_.asset_id
        << ", written by sealwatch: the unit in resources/inner with the laws that were found. */\n"
        << "#include <math.h>\n#include <stddef.h>\n#include <string.h>\n"
        << (inner.version == Version::fmi3 ? "#define FMI3\n" : "") << "#define MODEL_TOKEN "
        << c_text(description_.token) << "\n#define INNER_TOKEN " << c_text(inner.token) << "\n#define INNER_NAME "
        << c_text(inner.model_exchange->model_identifier) << "\n";
    for (const auto& [name, count] :
         std::initializer_list<std::pair<const char*, std::size_t>>{{"STATES", block_.states.size()},
                                                                    {"VARIABLES", block_.variables.size()},
                                                                    {"HIDDEN", description_.hidden.size()},
                                                                    {"CHANNELS", channels_.size()},
                                                                    {"PARAMETERS", values_.size()},
                                                                    {"INPUTS", inputs.size()},
                                                                    {"CALCULATED", calculated.size()},
                                                                    {"OUTPUTS", outputs_.size()}})
      out << "#define " << name << " " << count << "\n";
    out << "#define OWN " << ports_.own << "u\n\n"
        << "enum { kReal, kInteger, kBoolean, kText, kSingle, kInt8, kUInt8, kInt16, kUInt16, kUInt32, kInt64, "
           "kUInt64 };\n"
           "typedef struct {\n  unsigned reference;\n  int type, continuous;\n  double factor, offset;\n  int element, "
           "size;\n} "
           "Port;\n"
           "typedef struct {\n  unsigned reference;\n  int size, first;\n} Array;\n"
           "typedef struct {\n  Port port;\n  double value;\n  const char* text;\n} Setting;\n"
           "static int inner_values(void* model);\n\n"
        << table("state_ports", ports_.states) << table("rate_ports", ports_.rates)
        << table("variable_ports", ports_.variables) << table("input_ports", inputs)
        << table("calculated_ports", calculated) << table("channel_ports", channels_)
        << table("parameter_ports", values_) << arrays() << settings() << table("start_channels", channel_starts_)
        << table("start_parameters", value_starts_) << table("hidden_sizes", terms_.hidden_scales) << "\n";
    return out.str();
  }

  static std::string c_text(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
      if (c == '"' || c == '\\') result += '\\';
      result += c;
    }
    return result + "\"";
  }

  Result<std::string> source() const {
    std::vector<Node> inputs, parameters;
    for (const DrivenVariable* one : following(true)) inputs.push_back(one->node);
    for (const DrivenVariable* one : following(false)) parameters.push_back(one->node);
    std::string text = c_tables(parts_.expressions);
    for (const auto& [name, nodes] :
         {std::pair<const char*, const std::vector<Node>*>{"plant_rates", &parts_.derivatives.values},
          {"plant_signals", &parts_.signals.values},
          {"plant_inputs", &inputs},
          {"plant_parameters", &parameters},
          {"plant_outputs", &outputs_}})
      text += c_function(name, parts_, *nodes, rates_) + "\n";
    const std::string call = "  plant_signals(t, x, u, p, e, s);\n";
    const auto laws = laws_function(
        plant_.description, terms_,
        {.head = "static int model_laws(void* model, double t, const double* x, const double* u, const double* p, "
                 "double* e,\n                      double* hidden_rates) {\n",
         .signals = parts_.signals_see_added ? "  if (inner_values(model) != 0) return 3;\n" + call : call,
         .end = "  (void)model;\n  return 0;\n}\n",
         .first_site = block_.states.size() + block_.variables.size(),
         .signals_see_added = parts_.signals_see_added});
    if (!laws) return fail(laws.error());
    return text + helper_functions_c() + "\n" + *laws;
  }

  const RuntimePlant& plant_;
  const FmuEquations& unit_;
  const AssetConfig& asset_;
  const FmuBlock& block_;
  equations::TextEquationsParts parts_;  ///< its signals: those that laws in force see
  PhysicsTerms terms_;
  WrapperPorts ports_;
  WrapperVariables description_;
  std::vector<WrapperPort> channels_, values_;  ///< of u and p
  std::vector<double> channel_starts_, value_starts_;
  std::vector<std::size_t> rates_;
  std::vector<Node> outputs_;
};

}  // namespace

Result<ExportedModel> export_wrapper(const RuntimePlant& plant, const FmuEquations& equations,
                                     const AssetConfig& asset) {
  return WrapperExporter(plant, equations, asset).write();
}

}  // namespace sealwatch::fmi
