#include "services/common/fmi/import_fmu.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <sstream>

#include "sealwatch/core/file.hpp"
#include "services/common/fmi/fmu_plant.hpp"
#include "services/common/fmi/import_rows.hpp"
#include "services/common/fmi/import_start.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::fmi {
namespace {

// Of inputs, outputs and parameters alike; a plant file has a largest size (core/file.hpp).
constexpr std::size_t kMostInForce = 200;  ///< further ones come as comments,
constexpr std::size_t kMostListed = 600;   ///< and so many in all; where that is too long, none

std::string number(double value) {
  std::string result = text::exact(value);
  return result.find_first_of(".en") == std::string::npos ? result + ".0" : result;
}

std::string in_comment(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < 0x20; }, ' ');
  return text;
}

class PlantFileWriter {
 public:
  PlantFileWriter(const FmuFile& file, const std::string& path, ImportRows rows, ImportStart start, std::string by_name)
      : file_(file),
        fmu_(file.description()),
        path_(path),
        rows_(std::move(rows)),
        start_(std::move(start)),
        by_name_(std::move(by_name)) {}

  Result<std::string> write() {
    for (const std::size_t most : {kMostListed, kMostInForce})
      if (std::string text = written(most); text.size() <= kLongestYaml_bytes) return text;
    return fail(import_refusal(file_, std::to_string(rows_.states.size()) + " states",
                               "make a plant file longer than " + std::to_string(kLongestYaml_bytes) + " bytes",
                               "export the model with fewer states, or with shorter names"));
  }

 private:
  // `most`: rows of each group, comments among them.
  std::string written(std::size_t most) {
    out_ = {};
    listed_ = most;
    head();
    fmu_section();
    channels();
    parameter_rows();
    if (!file_.co_simulation()) {
      state_rows();
      site_rows();
    } else {
      out_ << "\n# Taken for Co-Simulation it integrates by itself and keeps its states, so that no law can be added "
              "to its\n"
              "# derivatives. fit, validate and explain work with its inputs, outputs, parameters and sensors; explain "
              "asks\n"
              "# no physics of it. "
           << (fmu_.offers_exchange ? "Imported with --interface me" : "Exported for Model Exchange")
           << " it can be asked for physics too.\n";
    }
    return out_.str();
  }

  // Of an array whose elements are of both signs, or vanish: as far as its largest, whichever way. Else 0.
  [[nodiscard]] double reach_of_array(const ImportRow& row) const {
    double least = std::numeric_limits<double>::infinity(), largest = -least;
    for (std::size_t k = 0; k < fmu_.variables[row.element.variable].size; ++k) {
      const double value = row.scale.to_si(start_.of_parameter(fmu_, {row.element.variable, k}));
      least = std::min(least, value), largest = std::max(largest, value);
    }
    if (least > 0.0 || largest < 0.0) return 0.0;
    const double size = std::max(-least, largest);
    return size == 0.0 ? 1.0 : 10.0 * size;
  }

  // Behind a row whose unit stayed unknown.
  [[nodiscard]] std::string unit_asked_for(const ImportRow& row) const {
    const Variable& variable = fmu_.variables[row.element.variable];
    if (variable.unit.empty() || variable.unit == "-" || fmu_.si_unit_of(variable)) return "";
    return "  # unit: the FMU does not define its " + in_comment(text::quoted(variable.unit)) +
           "; give what it is in SI";
  }

  void head() {
    const std::string version = fmu_.version == Version::fmi2 ? "FMI 2.0" : "FMI 3.0";
    out_ << "# A plant for sealwatch around the FMU " << in_comment(path_) << " (" << version << ", "
         << (file_.co_simulation() ? "Co-Simulation" : "Model Exchange")
         << (fmu_.tool.empty() ? "" : ", made by " + in_comment(fmu_.tool)) << ").\n"
         << "# Written by `sealwatch plant import`; complete what the comments ask for, then `sealwatch plant check` "
            "it.\n"
         << "# All units are SI: the FMU's own are converted.\n";
    if (!by_name_.empty())
      out_ << "# The FMU names these units and does not define them; each is taken as what its name is: "
           << in_comment(by_name_) << "\n";
    if (file_.interface().needs_execution_tool)
      out_ << "# It runs only where " << (fmu_.tool.empty() ? "the tool that made it" : in_comment(fmu_.tool))
           << " is installed (needsExecutionTool).\n";
    out_ << "\nname: " << name_for(fmu_.model_name, {}) << "\n"
         << "meaning: " << text::quoted(fmu_.description.empty() ? "the FMU " + fmu_.model_name : fmu_.description)
         << "\n";
  }

  // What is no quantity that a fit could move: as it was set, and as a comment what else could be.
  void settings() {
    if (!file_.settings().empty()) out_ << "  settings:      # of the FMU, set once before a run\n";
    for (const auto& [name, text] : file_.settings())
      out_ << "    " << text::quoted(name) << ": " << text::quoted(text) << "\n";
    std::size_t count = 0;
    for (const Variable& variable : fmu_.variables) {
      const bool real = variable.type == FmiType::float64 || variable.type == FmiType::float32;
      const bool structural = variable.causality == FmiCausality::structuralParameter;
      if (!(structural || (variable.causality == FmiCausality::parameter && !real)) ||
          variable.variability == FmiVariability::constant || file_.settings().contains(variable.name))
        continue;
      if (++count > listed_) continue;
      if (count == 1)
        out_ << "  # Parameters that can be set once, under `settings` (sizes of arrays: import with --set):\n";
      out_ << "  #   " << in_comment(text::quoted(variable.name)) << ":";
      for (const double value : variable.start) out_ << " " << number(value);
      std::string items;
      for (const Item& item : variable.items) text::add_to_list(items, number(item.value) + " " + item.name);
      out_ << (items.empty() ? "" : "  (" + in_comment(items) + ")") << "\n";
    }
  }

  template <class Write>
  void list(const std::vector<ImportRow>& rows, const char* indent, const Write& write) {
    for (std::size_t k = 0; k < std::min(rows.size(), listed_); ++k) {
      out_ << indent << (k < kMostInForce ? "" : "# ");
      write(rows[k]);
      out_ << "\n";
    }
  }

  void count_rest(const std::vector<ImportRow>& rows, const char* other_place) {
    if (rows.size() > listed_)
      out_ << "  # ... and " << rows.size() - listed_
           << " more: add those of modelDescription.xml that you need, here and in " << other_place << "\n";
  }

  void fmu_section() {
    out_ << "\nfmu:\n  file: " << text::quoted(path_) << "\n  interface: " << (file_.co_simulation() ? "cs" : "me");
    if (!file_.co_simulation() && fmu_.co_simulation)
      out_ << "  # it has Co-Simulation too: with its own solver (--interface cs), as published results of it are";
    out_ << "\n";
    settings();
    if (!rows_.inputs.empty())
      out_ << "  inputs:        # of the FMU, each an expression of the recorded inputs below\n";
    const auto name = [&](const ImportRow& row) {
      out_ << text::quoted(fmu_.name_of(row.element)) << ": " << row.name;
    };
    list(rows_.inputs, "    ", name);
    if (!rows_.parameters.empty())
      out_ << "  parameters:    # of the FMU, each an expression of the parameters below\n";
    list(rows_.parameters, "    ", name);
    out_ << "  variables:     # of the FMU, by the names that expressions use; any of its variables may be added\n";
    for (std::size_t k = 0; k < std::min(rows_.outputs.size(), listed_); ++k)
      if (const ImportRow& row = rows_.outputs[k]; !row.alias)
        out_ << (k < kMostInForce ? "    " : "    # ") << row.name
             << ": {variable: " << text::quoted(fmu_.name_of(row.element)) << ", unit: " << text::quoted(row.unit)
             << "}\n";
  }

  void channels() {
    if (!rows_.inputs.empty())
      out_ << "\n# Recorded inputs. Rename them to the recording's columns (here and in fmu.inputs); delete those that "
              "are not\n"
              "# recorded: the FMU then keeps its own start value.\n"
              "inputs:\n";
    list(rows_.inputs, "  ", [&](const ImportRow& row) {
      out_ << row.name << ": {unit: " << text::quoted(row.unit)
           << (changes_between_events(fmu_.variables[row.element.variable]) ? "" : ", course: held")
           << ", meaning: " << text::quoted(row.meaning) << "}" << unit_asked_for(row);
    });
    count_rest(rows_.inputs, "fmu.inputs");
    out_ << "\n# Recorded outputs. Rename them to the recording's columns, delete those that are not recorded.\n"
            "# noise_std: what the sensor's noise is; without it the recordings tell.\n"
            "outputs:\n";
    list(rows_.outputs, "  ", [&](const ImportRow& row) {
      out_ << row.channel << ": {unit: " << text::quoted(row.unit) << ", value: " << shown(row)
           << ", meaning: " << text::quoted(row.meaning) << "}" << unit_asked_for(row);
    });
    count_rest(rows_.outputs, "fmu.variables");
    if (rows_.outputs.empty())
      out_ << "  {}  # the FMU declares none: name variables of it in fmu.variables and use them here\n";
  }

  [[nodiscard]] const ImportRow* state_shown_by(const ImportRow& output) const {
    return output.state ? &rows_.states[*output.state] : nullptr;
  }

  // An output that is a state, under its own or another name, is taken as the state, which costs nothing.
  [[nodiscard]] std::string shown(const ImportRow& output) const {
    return output.alias ? state_shown_by(output)->name : output.name;
  }

  void parameter_rows() {
    if (rows_.parameters.empty()) return;
    out_ << "\n# Parameters. Set `estimate: true` for those that fit may change, with bounds that you believe in.\n"
            "parameters:\n";
    list(rows_.parameters, "  ", [&](const ImportRow& row) {
      const Variable& variable = fmu_.variables[row.element.variable];
      const double value = row.scale.to_si(start_.of_parameter(fmu_, row.element));
      const double reach = value == 0.0 ? 1.0 : 9.0 * std::abs(value);
      double min = value > 0.0 ? value / 10.0 : value - reach, max = value < 0.0 ? value / 10.0 : value + reach;
      if (const double of_all = variable.size > 1 ? reach_of_array(row) : 0.0; of_all > 0.0)
        max = of_all, min = -of_all;
      if (variable.min) min = std::max(min, row.scale.to_si(*variable.min));
      if (variable.max) max = std::min(max, row.scale.to_si(*variable.max));
      const bool sound = min <= value && value <= max && min < max;
      if (!sound) min = value - reach, max = value + reach;
      out_ << row.name << ": {unit: " << text::quoted(row.unit) << ", value: " << number(value)
           << ", min: " << number(min) << ", max: " << number(max)
           << ", estimate: false, meaning: " << text::quoted(row.meaning) << "}" << unit_asked_for(row);
    });
    count_rest(rows_.parameters, "fmu.parameters");
  }

  void state_rows() {
    if (rows_.states.empty()) return;
    out_ << "\n# States. `start` may be a channel, whose first value is taken, or rate(channel); a list is tried in "
            "turn.\n"
            "# start: fmu is the FMU's own, which its parameters or first inputs move.\n"
            "# size: how large it usually is (the integration keeps to a share of it).\n"
            "# own: true where each recording has a start of its own, which is estimated: here for the states that an "
            "output shows,\n"
            "# which begin at its first sample. The others begin at the FMU's start in every recording (own: false).\n"
            "states:\n";
    for (std::size_t k = 0; k < rows_.states.size(); ++k) {
      const ImportRow& row = rows_.states[k];
      const double start = row.scale.to_si(start_.beginning.states[k]);
      const double nominal = std::abs(row.scale.factor * nominal_of(k));
      const bool usual = std::isfinite(nominal) && nominal > 0.0;
      out_ << "  " << row.name << ": {variable: " << text::quoted(fmu_.name_of(row.element))
           << ", unit: " << text::quoted(row.unit)
           << ", start: " << (start_.linked[k] ? kStartOfFmu : start_of(row, start))
           << ", size: " << number(usual ? nominal : 1.0) << ", " << course_of_start(k)
           << ", meaning: " << text::quoted(row.meaning) << "}" << unit_asked_for(row) << "\n";
    }
  }

  [[nodiscard]] std::string course_of_start(std::size_t state) const {
    const std::string& begins = fmu_.variables[rows_.states[state].element.variable].begins;
    if (begins == kSettles && !start_.linked[state]) return "settles: true";
    const bool own = begins == kOwn || shown_by_output(rows_.states[state]);
    return own && !start_.linked[state] ? "own: true" : "own: false";
  }

  // Many binaries answer 1, as if nothing were known, whatever their description says.
  [[nodiscard]] double nominal_of(std::size_t state) const {
    const double of_binary = start_.beginning.nominals[state];
    const std::optional<double> described = fmu_.variables[rows_.states[state].element.variable].nominal;
    return of_binary == 1.0 ? described.value_or(of_binary) : of_binary;
  }

  [[nodiscard]] std::span<const ImportRow> recorded() const {
    return std::span(rows_.outputs).first(std::min(rows_.outputs.size(), kMostInForce));
  }

  [[nodiscard]] bool shown_by_output(const ImportRow& state) const {
    return std::ranges::any_of(recorded(), [&](const ImportRow& output) { return state_shown_by(output) == &state; });
  }

  [[nodiscard]] std::string start_of(const ImportRow& state, double value) const {
    std::string here = text::quoted(number(value) + "[" + state.unit + "]");
    for (const ImportRow& output : recorded())
      if (state_shown_by(output) == &state) return "[" + output.channel + ", " + here + "]";
    return here;
  }

  void site_rows() {
    out_ << "\n# Where physics may be missing: elements with sites, at which the laws of the catalogue (docs/laws.md) "
            "are tried.\n"
            "# What a law adds goes to the derivatives of states, with a factor; a loss counts positive. Or a site "
            "gets a\n"
            "# symbol, which an input of the FMU may contain. For a force on a mass M with the velocity v and the "
            "position x:\n"
            "# elements:\n"
            "#   piston:\n"
            "#     meaning: force on the piston\n"
            "#     sites:\n"
            "#       - {kind: piston_force, adds_to: {v: -1/M}, signals: {speed: v, position: x}}\n"
            "# Its derivatives are:";
    for (const Element& derivative : fmu_.derivatives) out_ << " " << in_comment(fmu_.name_of(derivative));
    out_ << "\nelements: {}\n"
            "\n# With sites: how many times larger each unit of their laws is here than on a 60 kN actuator; `plant "
            "check`\n"
            "# lists the units that are missing. For example {N: 0.02, m: 1, m/s: 10}.\n"
            "law_sizes: {}\n";
  }

  const FmuFile& file_;
  const ModelDescription& fmu_;
  const std::string& path_;
  ImportRows rows_;
  ImportStart start_;
  std::string by_name_;     ///< units that are taken by their names
  std::size_t listed_ = 0;  ///< rows of each group, at most
  std::ostringstream out_;
};

}  // namespace

Result<std::string> plant_file_of(const FmuFile& file, const std::string& path, const ImportOptions& options) {
  ImportRows rows = import_rows(file);
  if (const Status named = check_names(file, rows); !named) return fail(named.error());
  Result<ImportStart> start = start_unit(file, options, rows);
  if (!start) return fail(start.error());
  name_rows(file.description(), rows);
  std::vector<std::size_t> variables;
  for (const auto* group : {&rows.inputs, &rows.parameters, &rows.states, &rows.outputs})
    for (const ImportRow& row : *group)
      if (row.element.element == 0) variables.push_back(row.element.variable);
  std::ranges::sort(variables);
  variables.erase(std::ranges::unique(variables).begin(), variables.end());
  if (const std::string undefined = undefined_units(file.description(), variables); !undefined.empty())
    options.tell(undefined + ": " + kUndefinedUnits);
  return PlantFileWriter(file, path, std::move(rows), std::move(*start), units_by_name(file.description(), variables))
      .write();
}

}  // namespace sealwatch::fmi
