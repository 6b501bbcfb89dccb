// Parts of the reading of an asset file (asset_file.hpp) that stand in files of their own.
#pragma once

#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "services/common/runtime/yaml_map.hpp"

namespace sealwatch {

/// A number, or {value, min, max, estimate}; a value outside the description's bounds brings its own.
/// `positive`: what is said of one that must be positive and is not.
void read_parameter(YamlMap& parameters, const ParameterDescription& description, ParameterSetting& setting,
                    const NumberRule& positive = kPositive);

/// `physics:`, each term with exactly its law's parameters, within the law's bounds.
void read_physics(YamlMap& asset, const PlantDescription& plant, AssetConfig& config);

/// `alert_limits:` of quantities that are judged of such a plant.
void read_alert_limits(YamlMap& asset, const PlantDescription& plant, AssetConfig& config);

template <class Row>
[[nodiscard]] std::vector<std::string> names_of_rows(const std::vector<Row>& rows) {
  std::vector<std::string> names;
  for (const Row& row : rows) names.push_back(row.name);
  return names;
}

}  // namespace sealwatch
