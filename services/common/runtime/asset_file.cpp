#include "services/common/runtime/asset_file.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "sealwatch/core/asset_id.hpp"
#include "sealwatch/core/text.hpp"
#include "sealwatch/core/visible_text.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "services/common/runtime/asset_sections.hpp"
#include "services/common/runtime/channel_map_file.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "services/common/runtime/yaml_map.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch {
namespace {

/// A plant that is built in, by its name, or one in a file beside the asset's; null: there is none.
const PlantDescription* read_plant(YamlMap& asset, std::string& model, std::vector<Error>& errors) {
  std::vector<std::string> plants;
  for (const PlantDescription& plant : all_plants())
    if (plant.file.empty()) plants.push_back(plant.name);
  const auto node = asset.take("model");
  if (!node || !node->IsScalar() || !is_plant_file(node->Scalar())) {
    asset.read("model", model, plants);
    return *find_plant(model);
  }
  const std::filesystem::path file = std::filesystem::path(asset.file()).parent_path() / node->Scalar();
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) {
    asset.fault("model", node->Scalar(), "is not a file", "give the plant's file as seen from this one's folder");
    return nullptr;
  }
  const auto plant = load_plant(file.string());
  if (!plant) {
    errors.insert(errors.end(), plant.error().begin(), plant.error().end());
    return nullptr;
  }
  model = (*plant)->name;
  return *plant;
}

constexpr NumberRule kPositiveByItsMin{
    .min = 0.0,
    .min_excluded = true,
    .words = "must be a number above 0, as its min in the plant's file is: lower that where it may be negative"};

void read_parameters(YamlMap& asset, const PlantDescription& plant, AssetConfig& config) {
  for (const ParameterDescription& row : plant.parameters)
    config.parameters[row.name] = {row.value, row.min, row.max, row.estimate};
  auto parameters = asset.map("parameters");
  if (!parameters) return;
  for (const ParameterDescription& row : plant.parameters)
    read_parameter(*parameters, row, config.parameters[row.name], plant.file.empty() ? kPositive : kPositiveByItsMin);
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
                                     {"quantisation", &SensorSetting::quantisation},
                                     {"gain_tolerance", &SensorSetting::gain_tolerance},
                                     {"offset_tolerance", &SensorSetting::offset_tolerance},
                                     {"gain_error", &SensorSetting::gain_error},
                                     {"offset_error", &SensorSetting::offset_error}};
constexpr NumberRule kGain{.min = -1.0, .min_excluded = true, .words = "must be a number above -1"};

/// What is measured has noise, by which its residuals are divided; commands and switch positions may have none.
NumberRule rule_of(const SensorKey& key, const std::string& channel, const PlantDescription& plant) {
  if (key.target == &SensorSetting::gain_error) return kGain;
  if (key.target == &SensorSetting::offset_error) return kAnyNumber;
  const auto row = std::ranges::find(plant.channels, channel, &ChannelDescription::name);
  const bool has_noise = row != plant.channels.end() && row->noise_std > 0.0;
  if (key.target != &SensorSetting::noise_std) return kNotNegative;
  return has_noise ? kNoise : kNoiseOrNone;
}

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
    for (auto& [channel, setting] : config.sensors)
      by_channel->read(channel, setting.*key.target, rule_of(key, channel, plant));
    by_channel->finish();
  }
  for (auto& [channel, setting] : config.sensors) {
    auto sensor = sensors->map(channel);
    if (!sensor) continue;
    for (const SensorKey& key : kSensorKeys) sensor->read(key.name, setting.*key.target, rule_of(key, channel, plant));
    read_range(*sensor, setting);
    sensor->finish();
  }
  sensors->finish();
}

constexpr NumberRule kThreshold{
    .min = 0.0, .max = 1.0, .min_excluded = true, .words = "must be a number between 0 and 1"};

/// The condition as a line of the leakage resistance, of plants whose seal wears (INTERFACES section 2).
void read_seal(YamlMap& asset, const PlantDescription& plant, AssetConfig& config) {
  auto map = asset.map("seal");
  if (!map) return;
  if (!plant.condition) {
    asset.fault("seal", {}, "is for plants with a piston seal, and " + plant.name + " has none",
                "say what wears with condition: {parameter: ..., at_100: ..., at_60: ...}");
    return;
  }
  ConditionSetting seal = *plant.condition;
  map->read("resistance_100", seal.at_100, kPositive);
  map->read("resistance_60", seal.at_60, kPositive);
  map->read("threshold", seal.threshold, kThreshold);
  map->finish();
  if (seal.at_60 >= seal.at_100)
    map->fault("resistance_60", text::general(seal.at_60),
               "must be below resistance_100, " + text::general(seal.at_100) + ": a worn seal leaks more");
  config.condition = seal;
}

/// Which parameter wears, between which values and by which law.
void read_condition(YamlMap& asset, const PlantDescription& plant, AssetConfig& config) {
  if (plant.judged && !asset.has("seal") && !asset.has("condition")) config.condition = plant.condition;
  if (asset.has("seal") && asset.has("condition"))
    asset.fault("condition", {}, "says what `seal` says too", "keep one of them");
  read_seal(asset, plant, config);
  auto map = asset.map("condition");
  if (!map) return;
  ConditionSetting condition{.parameter = plant.wear_parameter};
  std::vector<std::string> names = names_of_rows(plant.parameters);
  if (!map->read("parameter", condition.parameter, names) && !map->has("parameter") && condition.parameter.empty())
    map->fault("parameter", {}, "must be given: what wears, as " + plant.name + " does not say it");
  std::string scale = "linear";
  map->read("scale", scale, {"linear", "logarithmic"});
  condition.logarithmic = scale == "logarithmic";
  bool known = !condition.parameter.empty();
  for (auto [key, target] : {std::pair{"at_100", &condition.at_100}, {"at_60", &condition.at_60}}) {
    if (map->read(key, *target, condition.logarithmic ? kPositive : kAnyNumber)) continue;
    if (!map->has(key)) map->fault(key, {}, "must be given: the parameter's value at that condition");
    known = false;
  }
  map->read("threshold", condition.threshold, kThreshold);
  map->read("part", condition.part);
  map->finish();
  if (!known) return;
  condition.unit = plant.find_parameter(condition.parameter)->unit;
  if (condition.part.empty())
    condition.part = plant.condition && plant.condition->parameter == condition.parameter
                         ? plant.condition->part
                         : "part whose " + condition.parameter + " wears";
  if (condition.at_100 == condition.at_60)
    map->fault("at_60", text::general(condition.at_60), "must differ from at_100");
  if (!config.parameters.at(condition.parameter).estimate)
    map->fault("parameter", condition.parameter, "is not estimated, so that no test says what it has become",
               "set estimate: true under parameters");
  config.condition = condition;
}

// What no valve actuator exceeds: the largest subsea valves travel about a metre, the fastest fail-safe ones in a
// second. A number beyond is a wrong unit, millimetres for instance.
constexpr NumberRule kStart{.min = 0.0, .max = 2.0, .words = "must be a position from 0 to 2 m"};
constexpr NumberRule kStroke{.min = -2.0, .max = 2.0, .words = "must be a way from -2 to 2 m"};
constexpr NumberRule kSpeed{.min = 1e-6, .max = 2.0, .words = "must be a speed from 1e-6 to 2 m/s"};
constexpr NumberRule kHold{.min = 0.0, .max = 3600.0, .words = "must be a time from 0 to 3600 s"};
constexpr NumberRule kInterval{.min = 0.1, .max = 120.0, .words = "must be a number of months from 0.1 to 120"};

void read_pst(YamlMap& asset, const PlantDescription& plant, AssetConfig& config) {
  auto map = asset.map("pst");
  if (!map) return;
  PstSetting& pst = config.pst;
  map->read("start", pst.start_m, kStart);
  map->read("stroke", pst.stroke_m, kStroke);
  map->read("speed", pst.speed_m_s, kSpeed);
  map->read("hold", pst.hold_s, kHold);
  map->read("interval_months", pst.interval_months, kInterval);
  map->finish();
  if (pst.stroke_m == 0.0) map->fault("stroke", "0", "must not be 0: a test has to move the stem");
  const ParameterDescription* described = plant.find_parameter(ParameterRole::stroke);
  if (described == nullptr) return;
  const auto stroke = config.parameters.find(described->name);
  const std::string rule = "must stay within the actuator's stroke, 0 to " + text::general(stroke->second.value) + " m";
  const double end_m = pst.start_m + pst.stroke_m;
  if (pst.start_m > stroke->second.value)
    map->fault("start", text::general(pst.start_m), rule);
  else if (end_m < 0.0 || end_m > stroke->second.value)
    map->fault("stroke", text::general(pst.stroke_m), "start + stroke is " + text::general(end_m) + " m: " + rule);
}

}  // namespace

Checked<AssetConfig> check_asset(const std::string& file, const std::vector<std::string>* sites) {
  std::vector<Error> errors;
  const auto root = load_yaml(file, errors);
  if (!root) return tl::unexpected(errors);
  YamlMap map(file, *root, {}, errors);
  AssetConfig config;
  if (!map.has("asset_id") && map.has("outputs")) {
    map.fault("outputs", {}, "stands in the file of a plant, not in that of an asset",
              "keep plants in a folder of their own and name one from the asset, as model: ../plants/FILE.yaml");
    return tl::unexpected(errors);
  }
  if (!map.has("asset_id"))
    map.fault("asset_id", {}, "must be given");
  else if (map.read("asset_id", config.asset_id))
    if (const auto wrong = config.asset_id.empty() ? "must not be empty" : fault_of_asset_id(config.asset_id))
      map.fault("asset_id", visible(config.asset_id, false), *wrong);
  if (map.read("site", config.site) && sites && std::ranges::find(*sites, config.site) == sites->end())
    map.fault("site", config.site, "is not one of the configuration's sites", suggest(config.site, *sites));
  map.read("segment", config.segment);
  const PlantDescription* known = read_plant(map, config.model, errors);
  if (known == nullptr) return tl::unexpected(errors);
  const PlantDescription& plant = *known;
  read_parameters(map, plant, config);
  read_sensors(map, plant, config);
  read_condition(map, plant, config);
  read_pst(map, plant, config);
  read_physics(map, plant, config);
  read_alert_limits(map, plant, config);
  read_channel_map(map, &plant, config.channel_map);
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
