// `sealwatch plant show`: the tables of a plant, built in or as text: states, channels, parameters, elements.
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "sealwatch/core/text.hpp"
#include "sealwatch/model/physics.hpp"
#include "services/cli/columns.hpp"
#include "services/cli/commands.hpp"
#include "services/cli/plant_laws.hpp"
#include "services/cli/session.hpp"
#include "services/cli/terminal.hpp"
#include "services/common/mismatch/site_words.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::cli {
namespace {

/// A site as it is shown: several places of one kind in an element are one.
struct ShownSite {
  std::string element;
  std::string kind;
  std::string unit;
  std::vector<std::string> laws;
};

struct ShownPlant {
  PlantDescription description;
  std::vector<ShownSite> sites;
};

void add_site(std::vector<ShownSite>& sites, ShownSite site) {
  if (std::ranges::none_of(
          sites, [&](const ShownSite& other) { return other.element == site.element && other.kind == site.kind; }))
    sites.push_back(std::move(site));
}

ShownPlant built_in(const PlantDescription& plant) {
  ShownPlant result{.description = plant, .sites = {}};
  for (const Site& site : plant.sites)
    add_site(result.sites, {.element = std::string(site.element),
                            .kind = std::string(name_of(site.kind)),
                            .unit = std::string(mismatch::words_of(site.kind).unit),
                            .laws = laws_at(site)});
  return result;
}

ShownPlant from_text(const ReadPlant& read) {
  ShownPlant result{.description = read.built.plant.description, .sites = {}};
  for (const equations::TextSite& site : read.text.sites)
    add_site(result.sites, {.element = site.element,
                            .kind = std::string(name_of(site.kind)),
                            .unit = site.unit,
                            .laws = laws_at(site, read.built.laws)});
  return result;
}

/// The plant of that name or file; its faults are listed on standard error.
std::optional<ShownPlant> shown_plant(const std::string& name) {
  if (is_plant_file(name)) {
    const Checked<ReadPlant> read = read_plant_file(name);
    if (read) return from_text(*read);
    for (const Error& error : read.error()) complain(error);
    return std::nullopt;
  }
  if (const auto plant = find_plant(name)) return built_in(**plant);
  std::vector<std::string> known;
  for (const PlantDescription& plant : all_plants()) known.push_back(plant.name);
  complain({.file = {},
            .place = {},
            .value = name,
            .rule = "is not a built-in plant, and a plant as text is named by its file, FILE.yaml",
            .advice = suggest(name, known)});
  return std::nullopt;
}

void print_states(const PlantDescription& plant) {
  std::vector<TableRow> rows;
  for (const StateDescription& state : plant.states)
    rows.push_back({state.name, "[" + state.unit + "]", state.meaning});
  print_table("States", rows);
}

void print_channels(const PlantDescription& plant) {
  std::vector<TableRow> inputs, outputs;
  for (const ChannelDescription& channel : plant.channels) {
    if (channel.input) {
      inputs.push_back({channel.name, "[" + channel.unit + "]", channel.meaning});
      continue;
    }
    std::string sensor = channel.noise_std > 0.0 ? "noise " + text::general(channel.noise_std) : "noise as recorded";
    if (channel.time_constant_s > 0.0) sensor += ", low-pass " + text::general(1e3 * channel.time_constant_s) + " ms";
    outputs.push_back({channel.name, "[" + channel.unit + "]", sensor, channel.meaning});
  }
  print_table("Inputs", inputs);
  print_table("Outputs (noise: standard deviation)", outputs);
}

void print_parameters(const PlantDescription& plant) {
  std::vector<TableRow> rows{{"", "", "default", "bounds", "tol.", "", ""}};
  for (const ParameterDescription& parameter : plant.parameters)
    rows.push_back({parameter.name, "[" + parameter.unit + "]", text::general(parameter.value),
                    text::general(parameter.min) + " to " + text::general(parameter.max), percent(parameter.tolerance),
                    parameter.estimate ? "free" : "fixed", parameter.meaning});
  if (rows.size() > 1)
    print_table("Parameters (free: estimated where the channels allow it; tol.: standard deviation of the value)",
                rows);
}

std::vector<std::string> kinds_from(SiteKind first, SiteKind last) {
  const auto& names = EnumNames<SiteKind>::kNames;
  return {names.begin() + static_cast<std::ptrdiff_t>(first), names.begin() + static_cast<std::ptrdiff_t>(last) + 1};
}

void print_elements(const ShownPlant& plant) {
  std::vector<TableRow> rows;
  for (const ElementDescription& element : plant.description.elements) {
    if (element.name.starts_with("sensor:")) continue;
    rows.push_back({element.name, element.meaning});
    for (const ShownSite& site : plant.sites)
      if (site.element == element.name)
        rows.push_back({"", site.kind + " [" + site.unit + "]: " +
                                (site.laws.empty() ? "no law of the catalogue" : text::joined(site.laws, ", "))});
  }
  rows.push_back({"sensor:CHANNEL", "measurement of an output"});
  rows.push_back({"", text::joined(kinds_from(SiteKind::sensor_bias, SiteKind::sensor_saturation))});
  rows.push_back({"input:CHANNEL", "record of an input"});
  rows.push_back({"", text::joined(kinds_from(SiteKind::input_gain, SiteKind::input_clock_rate))});
  rows.push_back({"clock", "the recording's clock"});
  rows.push_back({"", "clock_rate"});
  print_table("Elements, their sites, and the laws that explain tries there (sealwatch laws)", rows);
}

void print_law_sizes(const PlantDescription& plant) {
  std::vector<TableRow> rows;
  for (const LawSize& size : plant.law_sizes)
    rows.push_back({std::string(size.unit), "x " + text::general(size.factor)});
  print_table("Sizes of laws: those of eha times law_sizes", rows);
}

nlohmann::ordered_json channels_as_json(const PlantDescription& plant, bool input) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const ChannelDescription& channel : plant.channels) {
    if (channel.input != input) continue;
    list.push_back({{"name", channel.name}, {"unit", channel.unit}, {"meaning", channel.meaning}});
    if (input) continue;
    list.back()["noise_std"] = channel.noise_std;
    list.back()["time_constant_s"] = channel.time_constant_s;
  }
  return list;
}

nlohmann::ordered_json elements_as_json(const ShownPlant& plant) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const ElementDescription& element : plant.description.elements) {
    nlohmann::ordered_json sites = nlohmann::ordered_json::array();
    for (const ShownSite& site : plant.sites)
      if (site.element == element.name)
        sites.push_back({{"kind", site.kind}, {"unit", site.unit}, {"laws", site.laws}});
    list.push_back({{"name", element.name}, {"meaning", element.meaning}, {"sites", sites}});
  }
  return list;
}

nlohmann::ordered_json shown_as_json(const ShownPlant& shown) {
  const PlantDescription& plant = shown.description;
  nlohmann::ordered_json json = {{"schema", "sealwatch.plant/1"},
                                 {"name", plant.name},
                                 {"meaning", plant.meaning},
                                 {"load", plant.load_parameter},
                                 {"wears", plant.wear_parameter},
                                 {"states", nlohmann::ordered_json::array()},
                                 {"inputs", channels_as_json(plant, true)},
                                 {"outputs", channels_as_json(plant, false)},
                                 {"parameters", nlohmann::ordered_json::array()},
                                 {"elements", elements_as_json(shown)},
                                 {"law_sizes", nlohmann::ordered_json::object()}};
  for (const StateDescription& state : plant.states)
    json["states"].push_back({{"name", state.name}, {"unit", state.unit}, {"meaning", state.meaning}});
  for (const ParameterDescription& parameter : plant.parameters)
    json["parameters"].push_back({{"name", parameter.name},
                                  {"unit", parameter.unit},
                                  {"value", parameter.value},
                                  {"min", parameter.min},
                                  {"max", parameter.max},
                                  {"tolerance", parameter.tolerance},
                                  {"estimate", parameter.estimate},
                                  {"meaning", parameter.meaning}});
  for (const LawSize& size : plant.law_sizes) json["law_sizes"][std::string(size.unit)] = size.factor;
  return json;
}

}  // namespace

int run_plant_show(const PlantShowOptions& options) {
  const std::optional<ShownPlant> plant = shown_plant(options.name);
  if (!plant) return kBadInput;
  if (options.json) {
    std::printf("%s\n", shown_as_json(*plant).dump(1).c_str());
    return kOk;
  }
  const PlantDescription& description = plant->description;
  print_wrapped("Plant " + description.name + ": " + description.meaning, 0);
  if (description.has_load())
    print_wrapped("Load: " + description.load_parameter + ", with a factor of each recording's own", 0);
  if (!description.wear_parameter.empty()) print_wrapped("Wears: " + description.wear_parameter, 0);
  print_states(description);
  print_channels(description);
  print_parameters(description);
  print_elements(*plant);
  print_law_sizes(description);
  return kOk;
}

}  // namespace sealwatch::cli
