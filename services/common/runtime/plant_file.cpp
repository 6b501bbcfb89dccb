#include "services/common/runtime/plant_file.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <mutex>

#include "sealwatch/core/file.hpp"
#include "sealwatch/core/text.hpp"
#include "services/common/equations/derived_sizes.hpp"
#include "services/common/runtime/asset_sections.hpp"
#include "services/common/runtime/fmu_section.hpp"
#include "services/common/runtime/plant_sections.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch {
namespace {

using equations::TextPlant;

void read_range(YamlMap& map, ChannelDescription& channel) {
  const std::vector<YAML::Node> range = map.list("range");
  if (!map.has("range")) return;
  const auto number = [](const YAML::Node& node) { return node.IsScalar() ? number_of(node.Scalar()) : std::nullopt; };
  const auto min = range.size() == 2 ? number(range[0]) : std::nullopt;
  const auto max = range.size() == 2 ? number(range[1]) : std::nullopt;
  if (!min || !max || *min >= *max)
    return map.fault("range", {}, "must be two numbers, the lower one first: [min, max]");
  channel.range_min = *min;
  channel.range_max = *max;
}

/// What the row is to whoever watches the actuator; `none` where it is not given.
template <class Role>
Role read_role(YamlMap& map) {
  const auto& names = EnumNames<Role>::kNames;
  std::string role(names.front());
  map.read("role", role, {names.begin(), names.end()});
  return static_cast<Role>(std::ranges::find(names, role) - names.begin());
}

ChannelDescription read_channel(const std::string& name, YamlMap& map, const NumberRule& of_noise) {
  ChannelDescription channel{.name = name, .unit = {}, .meaning = name};
  need(map, "unit", channel.unit);
  map.read("meaning", channel.meaning);
  map.read("noise_std", channel.noise_std, of_noise);
  map.read("time_constant", channel.time_constant_s, kNotNegative);
  read_range(map, channel);
  channel.role = read_role<ChannelRole>(map);
  return channel;
}

void read_channels(YamlMap& root, TextPlant& plant) {
  for_each(root, "inputs", [&](const std::string& name, YamlMap& map) {
    equations::TextInput input{.channel = read_channel(name, map, kNoiseOrNone)};
    input.channel.input = true;
    std::string course = "as_recorded";
    map.read("course", course, {"as_recorded", "band_limited", "held", "averaged"});
    if (course == "held") input.course = InputCourse::held;
    if (course == "band_limited") input.course = InputCourse::band_limited;
    if (course == "averaged") input.course = InputCourse::averaged;
    input.channel.hold = course == "held" || course == "averaged";
    input.channel.band_limited = course == "band_limited";
    map.read("smoothing", input.smoothing_s, kNotNegative);
    plant.inputs.push_back(std::move(input));
  });
  for_each(root, "outputs", [&](const std::string& name, YamlMap& map) {
    equations::TextOutput output{.channel = read_channel(name, map, kNoise), .value = {}};
    need(map, "value", output.value);
    plant.outputs.push_back(std::move(output));
  });
}

constexpr NumberRule kToleranceShare{.min = 0.0,
                                     .max = 1.0,
                                     .min_excluded = true,
                                     .words = "must be a share of the value, above 0, at most 1: 0.01 for 1 %"};

void read_parameters(YamlMap& root, TextPlant& plant) {
  for_each(root, "parameters", [&](const std::string& name, YamlMap& map) {
    ParameterDescription parameter{.name = name, .unit = {}, .meaning = name};
    need(map, "unit", parameter.unit);
    map.read("meaning", parameter.meaning);
    const bool given = map.read("value", parameter.value);
    if (!given && !map.has("value")) map.fault("value", {}, "must be given");
    const double size = parameter.value < 0.0 ? -parameter.value : parameter.value;
    parameter.min = parameter.value > 0.0 ? 0.1 * parameter.value : -10.0 * size;
    parameter.max = 10.0 * size;
    map.read("min", parameter.min);
    map.read("max", parameter.max);
    map.read("tolerance", parameter.tolerance, parameter.min > 0.0 ? kToleranceShare : kPositive);
    map.read("estimate", parameter.estimate);
    parameter.role = read_role<ParameterRole>(map);
    if (given && size == 0.0 && !(map.has("min") && map.has("max")))
      map.fault("value", "0", "has no range that follows from it", "give min and max");
    else if (given && (!(parameter.min <= parameter.value && parameter.value <= parameter.max) ||
                       parameter.min == parameter.max))
      map.fault(
          "value", text::general(parameter.value),
          "must lie between min and max, " + text::general(parameter.min) + " and " + text::general(parameter.max));
    parameter.positive = parameter.min > 0.0;
    plant.parameters.push_back(std::move(parameter));
  });
}

void read_starts(YamlMap& map, equations::TextState& state) {
  const auto node = map.take("start");
  if (!node) return;
  if (node->IsScalar()) state.start = {node->Scalar()};
  if (!node->IsSequence()) return;
  for (const YAML::Node& item : *node)
    if (item.IsScalar())
      state.start.push_back(item.Scalar());
    else
      map.fault("start", {}, "must be an expression, or a list of expressions");
}

/// With an FMU a state names the variable that it is there, in place of its derivative.
void read_states(YamlMap& root, TextPlant& plant, fmi::FmuSection* fmu) {
  for_each(root, "states", [&](const std::string& name, YamlMap& map) {
    equations::TextState state{.description = {name, {}, name}, .rate = {}, .start = {}, .size = {}};
    if (fmu == nullptr)
      need(map, "der", state.rate);
    else if (fmu->states.push_back(name); map.has("variable"))
      map.read("variable", fmu->states.back());
    need(map, "unit", state.description.unit);
    map.read("meaning", state.description.meaning);
    double size = 0.0;
    if (map.read("size", size, kPositive)) state.size = size;
    map.read("own", state.own);
    map.read("settles", state.settles);
    if (state.settles && !map.has("own")) state.own = false;
    read_starts(map, state);
    plant.states.push_back(std::move(state));
  });
}

void read_rest(YamlMap& root, TextPlant& plant) {
  if (auto definitions = root.map("definitions")) {
    for (const std::string& name : definitions->keys()) {
      std::string text;
      if (definitions->read(name, text)) plant.definitions.emplace_back(name, text);
    }
    definitions->finish();
  }
  for_each(root, "tables", [&](const std::string& name, YamlMap& map) {
    equations::TextTable table{
        .name = name, .x_unit = "1", .y_unit = "1", .x = numbers(map, "x"), .y = numbers(map, "y")};
    map.read("x_unit", table.x_unit);
    map.read("y_unit", table.y_unit);
    plant.tables.push_back(std::move(table));
  });
  if (auto sizes = root.map("law_sizes")) {
    for (const std::string& unit : sizes->keys()) {
      double factor = 1.0;
      if (sizes->read(unit, factor, kPositive)) plant.law_sizes[unit] = factor;
    }
    equations::add_derived_sizes(plant.law_sizes);
    sizes->finish();
  }
  root.read("window_s", plant.window_s, kNotNegative);
  std::vector<std::string> parameters;
  for (const ParameterDescription& row : plant.parameters) parameters.push_back(row.name);
  root.read("load", plant.load, parameters);
  root.read("wears", plant.wears, parameters);
  if (auto unseen = root.map("not_recorded")) {
    need(*unseen, "drive", plant.not_recorded);
    need(*unseen, "record", plant.record);
    unseen->finish();
  }
  root.read("maximum_order", plant.maximum_order,
            {.min = 1.0, .max = 5.0, .words = "must be an order of integration from 1 to 5"});
}

}  // namespace

bool is_plant_file(const std::string& model) { return model.ends_with(".yaml") || model.ends_with(".yml"); }

Checked<ReadPlant> read_plant_file(const std::string& file) {
  std::vector<Error> errors;
  const auto node = load_yaml(file, errors);
  for (Error& error : errors)
    if (error.advice.empty() && error.rule.starts_with("is not YAML"))
      error.advice =
          "within {...} an expression with commas or square brackets needs quotes; lines are indented with blanks, not "
          "tabs";
  if (!node) return tl::unexpected(errors);
  YamlMap root(file, *node, {}, errors);
  ReadPlant read;
  TextPlant& plant = read.text;
  plant.file = file;
  need(root, "name", plant.name);
  if (const auto taken = find_plant(plant.name); taken && (*taken)->file.empty())
    root.fault("name", plant.name, "is the name of a plant that is built in", "give this plant another name");
  need(root, "meaning", plant.meaning);
  read_channels(root, plant);
  read_parameters(root, plant);
  auto fmu = read_fmu_section(root);
  read_states(root, plant, fmu ? &*fmu : nullptr);
  read_elements(root, plant);
  read_laws(root, plant);
  read_rest(root, plant);
  root.finish();
  if (!errors.empty()) return tl::unexpected(errors);
  const equations::Faults faults = [&](const std::string& key, const Error& error) {
    Error placed = error;
    placed.file = file;
    placed.place = place_in_yaml(*node, key) + (error.place.empty() ? "" : ", " + error.place);
    errors.push_back(std::move(placed));
  };
  auto built = fmu ? fmi::build_fmu_plant(plant, *fmu, faults) : equations::build_plant(plant, faults);
  if (!built) return tl::unexpected(errors);
  read.built = std::move(*built);
  return read;
}

Checked<const PlantDescription*> load_plant(const std::string& file) {
  static std::mutex mutex;
  static std::map<std::string, std::string> loaded;  // file and content, to the plant's name
  const std::scoped_lock lock(mutex);
  std::error_code ignored;
  const std::string path = std::filesystem::weakly_canonical(file, ignored).string();
  const Result<std::string> text = read_file(file, kLongestYaml_bytes);
  if (!text) return tl::unexpected(std::vector{text.error()});
  const std::string key = path + "\n" + content_hash(*text);
  if (const auto known = loaded.find(key); known != loaded.end()) return *find_plant(known->second);
  Checked<ReadPlant> read = read_plant_file(file);
  if (!read) return tl::unexpected(read.error());
  read->built.plant.description.file = path;
  read->built.plant.description.remarks = std::move(read->built.remarks);
  const std::string name = read->built.plant.description.name;
  if (const auto taken = find_plant(name))
    return tl::unexpected(
        std::vector{Error{file, place_in_yaml(file, "name"), name, "is the name of the plant in " + (*taken)->file,
                          "give this plant another name"}});
  for (Law& law : read->built.laws) add_law(std::move(law));
  const Status added = add_plant(std::move(read->built.plant));
  if (!added) return tl::unexpected(std::vector{added.error()});
  loaded[key] = name;
  return *find_plant(name);
}

}  // namespace sealwatch
