// `sealwatch plant check`: what was understood of a plant that is written as text, or every fault with its line.
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "sealwatch/core/rate_unit.hpp"
#include "sealwatch/core/visible_text.hpp"
#include "sealwatch/model/law_sizes.hpp"
#include "services/cli/columns.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/plant_laws.hpp"
#include "services/common/equations/own_law.hpp"
#include "services/common/equations/reference_quantity.hpp"
#include "services/common/equations/site_curves.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::cli {
namespace {

std::string tried_at(const equations::TextSite& site, const std::vector<Law>& own) {
  std::vector<std::string> laws = laws_at(site, own);
  if (equations::has_curves(site)) {
    std::vector<std::string> signals;
    for (const equations::TextSignal& signal : site.signals) signals.push_back(signal.name);
    laws.push_back("curves of " + text::joined(signals, " and "));
  }
  if (!laws.empty()) return text::joined(laws, ", ");
  return site.kind == SiteKind::own ? "nothing; with size at the site and at its signals, curves of them" : "nothing";
}

bool drives(const RuntimePlant& plant, const std::string& channel) {
  return std::ranges::find(plant.inputs, channel, &RuntimeInput::channel) != plant.inputs.end();
}

void print_plant(const std::string& file, const ReadPlant& read) {
  const PlantDescription& plant = read.built.plant.description;
  std::printf("%s: valid: plant %s, %s\n", file.c_str(), plant.name.c_str(), plant.meaning.c_str());
  std::vector<TableRow> rows;
  for (const equations::TextInput& input : read.text.inputs)
    rows.push_back({input.channel.name, "[" + input.channel.unit + "]",
                    drives(read.built.plant, input.channel.name) ? "drives the plant" : "stands in no equation",
                    input.channel.meaning});
  print_table("Inputs", rows);
  rows.clear();
  for (const equations::TextOutput& output : read.text.outputs)
    rows.push_back(
        {output.channel.name, "[" + output.channel.unit + "]", "= " + output.value,
         output.channel.noise_std > 0.0 ? "noise " + text::general(output.channel.noise_std) : "noise as recorded",
         output.channel.meaning});
  print_table("Outputs", rows);
  rows.clear();
  for (std::size_t k = 0; k < read.text.states.size(); ++k) {
    const equations::TextState& state = read.text.states[k];
    const char* own = state.settles ? "settles" : state.own ? "estimated" : "fixed";
    rows.push_back({"d " + state.description.name + "/dt", "[" + rate_unit(state.description.unit) + "]",
                    "= " + (state.rate.empty() ? "as the FMU says" : state.rate),
                    "from " + text::joined(state.start, " or "), own});
  }
  print_table("States", rows);
  rows.clear();
  for (const auto& [name, text] : read.text.definitions) rows.push_back({name, "= " + text});
  print_table("Definitions", rows);
  rows.clear();
  for (const ParameterDescription& parameter : plant.parameters)
    rows.push_back({parameter.name, text::general(parameter.value) + " " + parameter.unit,
                    "from " + text::general(parameter.min) + " to " + text::general(parameter.max),
                    parameter.estimate ? "estimated" : "fixed", parameter.meaning});
  print_table("Parameters", rows);
  rows.clear();
  for (const equations::TextSite& site : read.text.sites) {
    std::vector<std::string> seen;
    for (const equations::TextSignal& signal : site.signals)
      seen.push_back(signal.name + " = " + signal.value + " [" + signal.unit + "]");
    rows.push_back(
        {site.element, std::string(name_of(site.kind)) + " [" + site.unit + "]", "sees " + text::joined(seen, ", ")});
    rows.push_back({"", "", "tried there: " + tried_at(site, read.built.laws)});
  }
  print_table("Sites, where physics may be missing", rows);
  rows.clear();
  for (const equations::NeededSize& size : equations::needed_sizes(read.text)) {
    const double factor = read.text.law_sizes.at(size.unit);
    const LawParameter& parameter = *size.parameter;
    const auto here = [&](double value) { return text::general(factor * value) + " " + size.unit; };
    rows.push_back(
        {size.unit, "x " + text::general(factor),
         "of " + equations::in_words(equations::reference_quantity(size, read.text.sites), size.unit),
         std::string(size.law->id) + ": " + std::string(parameter.name) + " usually " + here(parameter.start.front()),
         parameter.strength ? "matters from " + here(parameter.significant) : "",
         "from " + here(parameter.min) + " to " + here(parameter.max)});
  }
  print_table("Sizes of laws: those of the 60 kN actuator times law_sizes, with one law as the example for each unit",
              rows);
}

nlohmann::ordered_json errors_of(const std::vector<Error>& errors) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Error& error : errors)
    list.push_back({{"file", error.file},
                    {"place", error.place},
                    {"value", error.value},
                    {"rule", error.rule},
                    {"advice", error.advice}});
  return list;
}

nlohmann::ordered_json plant_as_json(const std::string& file, const Checked<ReadPlant>& read) {
  nlohmann::ordered_json result = {{"schema", "sealwatch.plant_check/1"},
                                   {"file", file},
                                   {"valid", read.has_value()},
                                   {"errors", nlohmann::ordered_json::array()}};
  if (!read) {
    result["errors"] = errors_of(read.error());
    return result;
  }
  const PlantDescription& plant = read->built.plant.description;
  result["warnings"] = read->built.remarks;
  result["name"] = plant.name;
  for (const ChannelDescription& channel : plant.channels)
    result["channels"].push_back({{"name", channel.name}, {"unit", channel.unit}, {"input", channel.input}});
  for (const ParameterDescription& parameter : plant.parameters)
    result["parameters"].push_back({{"name", parameter.name},
                                    {"value", parameter.value},
                                    {"unit", parameter.unit},
                                    {"min", parameter.min},
                                    {"max", parameter.max},
                                    {"estimate", parameter.estimate}});
  for (const StateDescription& state : plant.states)
    result["states"].push_back({{"name", state.name}, {"unit", state.unit}});
  for (const equations::TextSite& site : read->text.sites)
    result["sites"].push_back({{"element", site.element},
                               {"kind", name_of(site.kind)},
                               {"unit", site.unit},
                               {"laws", laws_at(site, read->built.laws)}});
  for (const equations::NeededSize& size : equations::needed_sizes(read->text)) {
    const equations::ReferenceQuantity reference = equations::reference_quantity(size, read->text.sites);
    result["law_sizes"].push_back({{"unit", size.unit},
                                   {"size", read->text.law_sizes.at(size.unit)},
                                   {"one_is", reference.value},
                                   {"one_is_of", reference.meaning}});
  }
  return result;
}

}  // namespace

int run_plant_check(const PlantCheckOptions& options) {
  const Checked<ReadPlant> read = read_plant_file(options.file);
  if (options.json)
    std::printf(
        "%s\n",
        plant_as_json(options.file, read).dump(1, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  else if (read)
    print_plant(options.file, *read);
  for (std::size_t k = 0; read && !options.json && k < read->built.remarks.size(); ++k)
    std::fprintf(stderr, "sealwatch: warning: %s: %s\n", options.file.c_str(),
                 visible(read->built.remarks[k], false).c_str());
  if (!read && !options.json) {
    for (const Error& error : read.error()) std::fprintf(stderr, "%s\n", visible(error.describe()).c_str());
    std::fprintf(stderr, "%zu fault%s found\n", read.error().size(), read.error().size() == 1 ? "" : "s");
  }
  return read ? kOk : kBadInput;
}

}  // namespace sealwatch::cli
