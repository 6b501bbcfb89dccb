#include <algorithm>
#include <cmath>
#include <filesystem>

#include "sealwatch/core/file.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "services/common/runtime/channel_map_file.hpp"
#include "services/common/runtime/yaml_map.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch {
namespace {

/// The plant's file where it has one, as seen from a folder; "": the asset may be read anywhere.
std::string model_of(const AssetConfig& asset, const std::filesystem::path& folder) {
  const auto plant = find_plant(asset.model);
  if (!plant || (*plant)->file.empty()) return asset.model;
  std::error_code none;
  const std::filesystem::path seen = folder.empty() ? "" : std::filesystem::relative((*plant)->file, folder, none);
  return seen.empty() ? (*plant)->file : seen.string();
}

using Entries = std::vector<std::pair<std::string, std::string>>;

void write_flow(YAML::Emitter& out, const std::string& key, const Entries& entries) {
  out << YAML::Key << key << YAML::Value << YAML::Flow << YAML::BeginMap;
  for (const auto& [name, value] : entries) out << YAML::Key << name << YAML::Value << value;
  out << YAML::EndMap;
}

/// A tenth of a value without the last digits of the division: 0.15 and not 0.15000000000000002.
double rounded_bound(double bound) {
  constexpr int kDigits = 12;
  return number_of(text::significant(bound, kDigits)).value_or(bound);
}

void write_setting(YAML::Emitter& out, const std::string& name, const ParameterSetting& setting) {
  const double min = rounded_bound(setting.min), max = rounded_bound(setting.max);
  Entries entries = {{"value", text::exact(std::clamp(setting.value, min, max))},
                     {"min", text::exact(min)},
                     {"max", text::exact(max)},
                     {"estimate", setting.estimate ? "true" : "false"}};
  // Of a value that came out smaller than it was given: a tolerance above the value is refused.
  const double tolerance = setting.min > 0.0 ? std::min(setting.tolerance, setting.value) : setting.tolerance;
  if (tolerance > 0.0) entries.emplace_back("tolerance", text::exact(tolerance));
  write_flow(out, name, entries);
}

void write_parameters(YAML::Emitter& out, const AssetConfig& asset) {
  out << YAML::Key << "parameters" << YAML::Value << YAML::BeginMap;
  for (const auto& [name, setting] : asset.parameters) write_setting(out, name, setting);
  out << YAML::EndMap;
}

void write_sensors(YAML::Emitter& out, const AssetConfig& asset) {
  out << YAML::Key << "sensors" << YAML::Value << YAML::BeginMap;
  for (const auto& [channel, sensor] : asset.sensors) {
    out << YAML::Key << channel << YAML::Value << YAML::Flow << YAML::BeginMap;
    out << YAML::Key << "noise_std" << YAML::Value << text::exact(sensor.noise_std);
    out << YAML::Key << "time_constant" << YAML::Value << text::exact(sensor.time_constant_s);
    out << YAML::Key << "quantisation" << YAML::Value << text::exact(sensor.quantisation);
    for (const auto& [key, value] : {std::pair{"gain_tolerance", sensor.gain_tolerance},
                                     {"offset_tolerance", sensor.offset_tolerance},
                                     {"gain_error", sensor.gain_error},
                                     {"offset_error", sensor.offset_error}})
      if (value != 0.0) out << YAML::Key << key << YAML::Value << text::exact(value);
    if (sensor.range_max > sensor.range_min)
      out << YAML::Key << "range" << YAML::Value << YAML::BeginSeq << text::exact(sensor.range_min)
          << text::exact(sensor.range_max) << YAML::EndSeq;
    out << YAML::EndMap;
  }
  out << YAML::EndMap;
}

/// As `seal:` where that says it.
void write_condition(YAML::Emitter& out, const AssetConfig& asset) {
  const auto plant = find_plant(asset.model);
  const std::optional<ConditionSetting> of_plant = plant ? (*plant)->condition : std::nullopt;
  if (!asset.condition) {
    if (of_plant) out << YAML::Key << "seal" << YAML::Value << YAML::Null;
    return;
  }
  const ConditionSetting& condition = *asset.condition;
  if (of_plant && condition.parameter == of_plant->parameter && condition.logarithmic == of_plant->logarithmic)
    return write_flow(out, "seal",
                      {{"resistance_100", text::exact(condition.at_100)},
                       {"resistance_60", text::exact(condition.at_60)},
                       {"threshold", text::exact(condition.threshold)}});
  write_flow(out, "condition",
             {{"parameter", condition.parameter},
              {"at_100", text::exact(condition.at_100)},
              {"at_60", text::exact(condition.at_60)},
              {"threshold", text::exact(condition.threshold)},
              {"scale", condition.logarithmic ? "logarithmic" : "linear"},
              {"part", condition.part}});
}

void write_limits(YAML::Emitter& out, const AssetConfig& asset) {
  if (asset.alert_limits.empty()) return;
  out << YAML::Key << "alert_limits" << YAML::Value << YAML::BeginMap;
  for (const auto& [quantity, limits] : asset.alert_limits)
    write_flow(out, quantity,
               {{"advisory", text::exact(limits.advisory)},
                {"warning", text::exact(limits.warning)},
                {"alarm", text::exact(limits.alarm)}});
  out << YAML::EndMap;
}

void write_physics(YAML::Emitter& out, const AssetConfig& asset) {
  if (asset.physics.empty()) return;
  out << YAML::Key << "physics" << YAML::Value << YAML::BeginSeq;
  for (const PhysicsTerm& term : asset.physics) {
    out << YAML::BeginMap << YAML::Key << "id" << YAML::Value << term.id;
    out << YAML::Key << "element" << YAML::Value << term.element;
    out << YAML::Key << "parameters" << YAML::Value << YAML::BeginMap;
    for (const auto& [name, setting] : term.parameters) write_setting(out, name, setting);
    out << YAML::EndMap;
    out << YAML::EndMap;
  }
  out << YAML::EndSeq;
}

/// A machine with a model of its own need not have one.
void write_pst(YAML::Emitter& out, const AssetConfig& asset) {
  const auto entries_of = [](const PstSetting& pst) {
    return Entries{{"start", text::exact(pst.start_m)},
                   {"stroke", text::exact(pst.stroke_m)},
                   {"speed", text::exact(pst.speed_m_s)},
                   {"hold", text::exact(pst.hold_s)},
                   {"interval_months", text::exact(pst.interval_months)}};
  };
  const Entries entries = entries_of(asset.pst);
  const auto plant = find_plant(asset.model);
  const bool has_own_model = plant && !(*plant)->file.empty();
  if (!has_own_model || entries != entries_of({})) write_flow(out, "pst", entries);
}

std::string yaml_of(const AssetConfig& asset, const std::filesystem::path& folder) {
  YAML::Emitter out;
  out << YAML::BeginMap;
  for (const auto& [key, value] : {std::pair{"asset_id", asset.asset_id},
                                   {"site", asset.site},
                                   {"segment", asset.segment},
                                   {"model", model_of(asset, folder)}})
    if (!value.empty()) out << YAML::Key << key << YAML::Value << value;
  write_parameters(out, asset);
  write_sensors(out, asset);
  write_condition(out, asset);
  write_pst(out, asset);
  write_limits(out, asset);
  write_physics(out, asset);
  out << YAML::EndMap;
  return std::string(out.c_str()) + "\n" + channel_map_to_yaml(asset.channel_map);
}

}  // namespace

std::string asset_to_yaml(const AssetConfig& asset) { return yaml_of(asset, {}); }

Status save_asset(const AssetConfig& asset, const std::string& file) {
  return write_file(file, yaml_of(asset, std::filesystem::absolute(file).parent_path()));
}

}  // namespace sealwatch
