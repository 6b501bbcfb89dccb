#include "services/common/runtime/asset_file.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "sealwatch/core/text.hpp"
#include "sealwatch/model/physics.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "services/common/runtime/yaml_map.hpp"

namespace sealwatch {
namespace {

constexpr double kNoBound = 1e300;

template <class Row>
std::vector<std::string> names_of(const std::vector<Row>& rows) {
  std::vector<std::string> names;
  for (const Row& row : rows) names.push_back(row.name);
  return names;
}

std::string text_of(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", number);
  return text;
}

const PlantDescription* read_plant(YamlMap& asset, std::string& model) {
  std::vector<std::string> plants;
  for (const PlantDescription& plant : all_plants()) plants.push_back(plant.name);
  asset.read("model", model, plants);
  return *find_plant(model);
}

/// Bounds for a value that lies outside the table's and has none of its own.
void widen(ParameterSetting& setting, const ParameterDescription& description) {
  if (setting.value >= setting.min && setting.value <= setting.max) return;
  if (description.positive) {
    setting.min = setting.value / 10.0;
    setting.max = setting.value * 10.0;
  } else {
    setting.min = std::min(setting.min, setting.value);
    setting.max = std::max(setting.max, setting.value);
  }
}

void read_parameter(YamlMap& parameters, const ParameterDescription& description, ParameterSetting& setting) {
  const std::string& name = description.name;
  const NumberRule& rule = description.positive ? kPositive : kAnyNumber;
  const auto node = parameters.take(name);
  if (!node) return;
  if (node->IsScalar()) {
    if (parameters.read(name, setting.value, rule)) widen(setting, description);
    return;
  }
  YamlMap map = parameters.inside(*node, name);
  const bool has_bounds = map.has("min") || map.has("max");
  bool sound = true;
  for (auto [key, target] : {std::pair{"value", &setting.value}, {"min", &setting.min}, {"max", &setting.max}})
    sound = (map.read(key, *target, rule) || !map.has(key)) && sound;
  map.read("estimate", setting.estimate);
  map.finish();
  if (!sound) return;
  if (!has_bounds) widen(setting, description);
  if (setting.min > setting.max)
    map.fault(map.has("min") ? "min" : "max", text_of(map.has("min") ? setting.min : setting.max),
              "min must not be above max, which are " + text_of(setting.min) + " and " + text_of(setting.max));
  else if (setting.value < setting.min || setting.value > setting.max)
    map.fault("value", text_of(setting.value),
              "must lie between min and max, " + text_of(setting.min) + " and " + text_of(setting.max));
}

void read_parameters(YamlMap& asset, const PlantDescription& plant, AssetConfig& config) {
  for (const ParameterDescription& row : plant.parameters)
    config.parameters[row.name] = {row.value, row.min, row.max, row.estimate};
  auto parameters = asset.map("parameters");
  if (!parameters) return;
  for (const ParameterDescription& row : plant.parameters)
    read_parameter(*parameters, row, config.parameters[row.name]);
  parameters->finish();
}

void read_range(YamlMap& sensor, SensorSetting& setting) {
  const std::vector<YAML::Node> range = sensor.list("range");
  if (!sensor.has("range")) return;
  const auto number = [](const YAML::Node& node) { return node.IsScalar() ? number_of(node.Scalar()) : std::nullopt; };
  const auto min = range.size() == 2 ? number(range[0]) : std::nullopt;
  const auto max = range.size() == 2 ? number(range[1]) : std::nullopt;
  if (!min || !max || *min >= *max) {
    sensor.fault("range", {}, "must be two numbers, the lower one first: [min, max]");
    return;
  }
  setting.range_min = *min;
  setting.range_max = *max;
}

struct SensorKey {
  const char* name;
  double SensorSetting::*target;
};
constexpr SensorKey kSensorKeys[] = {{"noise_std", &SensorSetting::noise_std},
                                     {"time_constant", &SensorSetting::time_constant_s},
                                     {"quantisation", &SensorSetting::quantisation}};

/// Either channel by channel, {pressure_a: {noise_std: 1.0e4}}, or key by key, {noise_std: {pressure_a: 1.0e4}}.
void read_sensors(YamlMap& asset, const PlantDescription& plant, AssetConfig& config) {
  for (const ChannelDescription& row : plant.channels)
    config.sensors[row.name] = {row.noise_std, row.time_constant_s, 0.0, row.range_min, row.range_max};
  auto sensors = asset.map("sensors");
  if (!sensors) return;
  for (const SensorKey& key : kSensorKeys) {
    if (!sensors->has(key.name)) continue;
    auto by_channel = sensors->map(key.name);
    if (!by_channel) continue;
    for (auto& [channel, setting] : config.sensors) by_channel->read(channel, setting.*key.target, kNotNegative);
    by_channel->finish();
  }
  for (auto& [channel, setting] : config.sensors) {
    auto sensor = sensors->map(channel);
    if (!sensor) continue;
    for (const SensorKey& key : kSensorKeys) sensor->read(key.name, setting.*key.target, kNotNegative);
    read_range(*sensor, setting);
    sensor->finish();
  }
  sensors->finish();
}

void read_seal(YamlMap& asset, AssetConfig& config) {
  if (config.model == "eha" && !asset.has("seal")) config.seal = SealSetting();
  auto map = asset.map("seal");
  if (!map) return;
  SealSetting seal;
  map->read("resistance_100", seal.resistance_100_Pa_s_m3, kPositive);
  map->read("resistance_60", seal.resistance_60_Pa_s_m3, kPositive);
  map->read("threshold", seal.threshold,
            {.min = 0.0, .max = 1.0, .min_excluded = true, .words = "must be a number between 0 and 1"});
  map->finish();
  if (seal.resistance_60_Pa_s_m3 >= seal.resistance_100_Pa_s_m3)
    map->fault("resistance_60", text_of(seal.resistance_60_Pa_s_m3),
               "must be below resistance_100, " + text_of(seal.resistance_100_Pa_s_m3) + ": a worn seal leaks more");
  config.seal = seal;
}

void read_pst(YamlMap& asset, AssetConfig& config) {
  auto map = asset.map("pst");
  if (!map) return;
  PstSetting& pst = config.pst;
  map->read("start", pst.start_m, kNotNegative);
  map->read("stroke", pst.stroke_m);
  map->read("speed", pst.speed_m_s, kPositive);
  map->read("hold", pst.hold_s, kNotNegative);
  map->read("interval_months", pst.interval_months, kPositive);
  map->finish();
  if (pst.stroke_m == 0.0) map->fault("stroke", "0", "must not be 0: a test has to move the stem");
  const auto stroke = config.parameters.find("x_C");
  if (stroke == config.parameters.end()) return;
  const std::string rule = "must stay within the actuator's stroke, 0 to " + text_of(stroke->second.value) + " m";
  const double end_m = pst.start_m + pst.stroke_m;
  if (pst.start_m > stroke->second.value)
    map->fault("start", text_of(pst.start_m), rule);
  else if (end_m < 0.0 || end_m > stroke->second.value)
    map->fault("stroke", text_of(pst.stroke_m), "start + stroke is " + text_of(end_m) + " m: " + rule);
}

/// A law's parameter: a plain number is fixed; {value, min, max, estimate} may be estimated. Bounds are the law's.
ParameterDescription describe(const Law* law, const std::string& name) {
  ParameterDescription row{.name = name, .unit = {}, .meaning = {}, .positive = false};
  row.min = -kNoBound, row.max = kNoBound;
  if (law == nullptr) return row;
  for (const LawParameter& parameter : law->parameters)
    if (parameter.name == name) row.min = parameter.min, row.max = parameter.max;
  return row;
}

void read_law_parameters(YamlMap& map, PhysicsTerm& term) {
  auto parameters = map.map("parameters");
  if (!parameters) return;
  const std::vector<std::string> names = parameters->keys();
  const Result<const Law*> law = find_law(term.id, names);
  if (!law && !term.id.empty()) map.fault("id", term.id, law.error().rule, law.error().advice);
  for (const std::string& name : names) {
    const ParameterDescription row = describe(law ? *law : nullptr, name);
    ParameterSetting& setting = term.parameters[name] = {0.0, row.min, row.max, false};
    read_parameter(*parameters, row, setting);
  }
}

void read_physics(YamlMap& asset, const PlantDescription& plant, AssetConfig& config) {
  std::vector<std::string> elements = names_of(plant.elements);
  for (const ChannelDescription& channel : plant.channels)
    elements.push_back(std::string("sensor:").append(channel.name));
  std::size_t index = 0;
  for (const YAML::Node& node : asset.list("physics")) {
    YamlMap map = asset.inside(node, "physics", index++);
    PhysicsTerm term;
    if (!map.read("id", term.id) && !map.has("id")) map.fault("id", {}, "must be given");
    if (!map.read("element", term.element, elements) && !map.has("element")) map.fault("element", {}, "must be given");
    read_law_parameters(map, term);
    map.finish();
    config.physics.push_back(std::move(term));
  }
}

void read_alert_limits(YamlMap& asset, AssetConfig& config) {
  auto all = asset.map("alert_limits");
  if (!all) return;
  for (const std::string& quantity : all->keys()) {
    auto map = all->map(quantity);
    if (!map) continue;
    AlertLimits limits;
    bool complete = true;
    for (auto [key, target] :
         {std::pair{"advisory", &limits.advisory}, {"warning", &limits.warning}, {"alarm", &limits.alarm}}) {
      if (map->read(key, *target)) continue;
      if (!map->has(key)) map->fault(key, {}, "must be given");
      complete = false;
    }
    map->finish();
    const bool rising = limits.advisory <= limits.warning && limits.warning <= limits.alarm;
    const bool falling = limits.advisory >= limits.warning && limits.warning >= limits.alarm;
    if (complete && !rising && !falling)
      map->fault("warning", text_of(limits.warning),
                 "must lie between advisory and alarm, " + text_of(limits.advisory) + " and " + text_of(limits.alarm));
    config.alert_limits[quantity] = limits;
  }
}

}  // namespace

Checked<AssetConfig> check_asset(const std::string& file, const std::vector<std::string>* sites) {
  std::vector<Error> errors;
  const auto root = load_yaml(file, errors);
  if (!root) return tl::unexpected(errors);
  YamlMap map(file, *root, {}, errors);
  AssetConfig config;
  if (!map.read("asset_id", config.asset_id) && !map.has("asset_id"))
    map.fault("asset_id", {}, "must be given");
  else if (map.has("asset_id") && config.asset_id.empty())
    map.fault("asset_id", {}, "must not be empty");
  else if (std::ranges::any_of(config.asset_id, [](unsigned char c) { return std::iscntrl(c) != 0; }))
    // It stands in topics, logs and file names, each on one line.
    map.fault("asset_id", {}, "must not have line breaks or other control characters");
  if (map.read("site", config.site) && sites && std::ranges::find(*sites, config.site) == sites->end())
    map.fault("site", config.site, "is not one of the configuration's sites", suggest(config.site, *sites));
  map.read("segment", config.segment);
  const PlantDescription& plant = *read_plant(map, config.model);
  read_parameters(map, plant, config);
  read_sensors(map, plant, config);
  read_seal(map, config);
  read_pst(map, config);
  read_physics(map, plant, config);
  read_alert_limits(map, config);
  map.finish();
  if (!errors.empty()) return tl::unexpected(errors);
  return config;
}

Error combine(const std::vector<Error>& errors) {
  Error first = errors.front();
  for (std::size_t k = 1; k < errors.size(); ++k) first.advice.append("\n").append(errors[k].describe());
  return first;
}

Result<AssetConfig> load_asset(const std::string& file) {
  Checked<AssetConfig> asset = check_asset(file);
  if (!asset) return fail(combine(asset.error()));
  return std::move(*asset);
}

}  // namespace sealwatch
