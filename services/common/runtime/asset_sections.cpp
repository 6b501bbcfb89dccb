#include "services/common/runtime/asset_sections.hpp"

#include <algorithm>
#include <optional>

#include "sealwatch/config/judged_quantities.hpp"
#include "sealwatch/core/text.hpp"
#include "sealwatch/model/law_sizes.hpp"
#include "sealwatch/model/physics.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch {
namespace {

constexpr double kNoBound = 1e300;

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

/// A law's parameter: a plain number is fixed; {value, min, max, estimate} may be estimated. Bounds are the law's.
ParameterDescription describe(const Law* law, const std::string& name, const PlantDescription& plant) {
  ParameterDescription row{.name = name, .unit = {}, .meaning = {}, .positive = false};
  row.min = -kNoBound, row.max = kNoBound;
  if (law == nullptr) return row;
  for (const LawParameter& parameter : law->parameters)
    if (parameter.name == name) {
      const LawBounds bounds = law_bounds(plant, parameter);
      row.min = bounds.min, row.max = bounds.max, row.unit = parameter.unit;
    }
  return row;
}

/// A law holds within its bounds only: a leakage that is negative, for instance, would pump.
void check_bounds(const YamlMap& parameters, const ParameterDescription& row, const ParameterSetting& setting) {
  for (const double number : {setting.value, setting.min, setting.max}) {
    if (number >= row.min && number <= row.max) continue;
    std::string rule = "must stay within the law's bounds, ";
    rule.append(text::general(row.min)).append(" to ").append(text::general(row.max)).append(" ").append(row.unit);
    parameters.fault(row.name, text::general(number), std::move(rule));
    return;
  }
}

void read_law_parameter(YamlMap& parameters, const ParameterDescription& row, ParameterSetting& setting) {
  const std::optional<YAML::Node> node = parameters.take(row.name);
  if (node && node->IsMap() && !(*node)["value"]) {
    parameters.fault(row.name, {}, "needs a value", "write {value: ..., min: ..., max: ..., estimate: true}");
    return;
  }
  read_parameter(parameters, row, setting);
  check_bounds(parameters, row, setting);
}

void read_law_parameters(YamlMap& map, const PlantDescription& plant, PhysicsTerm& term) {
  auto parameters = map.map("parameters");
  const std::vector<std::string> names = parameters ? parameters->keys() : std::vector<std::string>();
  const Result<const Law*> law = find_law(term.id, names, plant.name);
  if (!law && !term.id.empty()) map.fault("id", term.id, law.error().rule, law.error().advice);
  for (const std::string& name : names) {
    const ParameterDescription row = describe(law ? *law : nullptr, name, plant);
    ParameterSetting& setting = term.parameters[name] = {std::clamp(0.0, row.min, row.max), row.min, row.max, false};
    read_law_parameter(*parameters, row, setting);
  }
}

/// What state detection judges of such a plant.
std::vector<std::string> quantities_of(const PlantDescription& plant) {
  std::vector<ChannelDescription> simulated = plant.channels;
  std::erase_if(simulated, [](const ChannelDescription& channel) { return channel.input; });
  return judged_quantities(names_of_rows(simulated), names_of_rows(plant.channels));
}

/// Plant files give the tolerance as a share of the value: whoever does so here would set a small value free.
void check_tolerance(YamlMap& map, const ParameterDescription& description, const ParameterSetting& setting) {
  const double size = std::abs(setting.value);
  if (!description.positive || setting.estimate || setting.tolerance <= size) return;
  map.fault("tolerance", text::general(setting.tolerance),
            "must not be above the value, " + text::general(setting.value) + " " + description.unit +
                ", in whose unit it is one standard deviation",
            setting.tolerance < 1.0 ? "a share of " + text::general(setting.tolerance) + " is written " +
                                          text::general(setting.tolerance * size)
                                    : "");
}

}  // namespace

void read_parameter(YamlMap& parameters, const ParameterDescription& description, ParameterSetting& setting,
                    const NumberRule& positive) {
  const std::string& name = description.name;
  const NumberRule& rule = description.positive ? positive : kAnyNumber;
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
  map.read("tolerance", setting.tolerance, kNotNegative);
  map.finish();
  if (!sound) return;
  check_tolerance(map, description, setting);
  if (!has_bounds) widen(setting, description);
  if (setting.min > setting.max)
    map.fault(
        map.has("min") ? "min" : "max", text::general(map.has("min") ? setting.min : setting.max),
        "min must not be above max, which are " + text::general(setting.min) + " and " + text::general(setting.max));
  else if (setting.value < setting.min || setting.value > setting.max)
    map.fault("value", text::general(setting.value),
              "must lie between min and max, " + text::general(setting.min) + " and " + text::general(setting.max));
}

void read_physics(YamlMap& asset, const PlantDescription& plant, AssetConfig& config) {
  std::vector<std::string> elements = names_of_rows(plant.elements);
  for (const ChannelDescription& channel : plant.channels) {
    elements.push_back(std::string("sensor:").append(channel.name));
    elements.push_back(std::string("input:").append(channel.name));
  }
  elements.emplace_back("clock");
  std::size_t index = 0;
  for (const YAML::Node& node : asset.list("physics")) {
    YamlMap map = asset.inside(node, "physics", index++);
    PhysicsTerm term;
    if (!map.read("id", term.id) && !map.has("id")) map.fault("id", {}, "must be given");
    if (!map.read("element", term.element, elements) && !map.has("element")) map.fault("element", {}, "must be given");
    read_law_parameters(map, plant, term);
    map.finish();
    config.physics.push_back(std::move(term));
  }
}

void read_alert_limits(YamlMap& asset, const PlantDescription& plant, AssetConfig& config) {
  auto all = asset.map("alert_limits");
  if (!all) return;
  const std::vector<std::string> judged = quantities_of(plant);
  for (const std::string& quantity : all->keys()) {
    auto map = all->map(quantity);
    if (std::ranges::find(judged, quantity) == judged.end()) {
      all->fault(quantity, quantity, "is not a quantity that is judged", suggest(quantity, judged));
      continue;
    }
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
      map->fault("warning", text::general(limits.warning),
                 "must lie between advisory and alarm, " + text::general(limits.advisory) + " and " +
                     text::general(limits.alarm));
    config.alert_limits[quantity] = limits;
  }
}

}  // namespace sealwatch
