// Reads the public recordings for the model's tests: trusts their format, converts the units that occur there.
#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/time_series.hpp"
#include "sealwatch/core/units.hpp"
#include "sealwatch/model/plant_description.hpp"

namespace sealwatch {

inline TimeSeries read_recording(const std::filesystem::path& file) {
  TimeSeries samples;
  std::vector<UnitConversion> conversions;
  std::ifstream stream(file);
  std::string line, cell;
  std::getline(stream, line);
  for (std::istringstream header(line); std::getline(header, cell, ',');) {
    const auto bracket = cell.find('[');
    const std::string unit = cell.substr(bracket + 1, cell.find(']') - bracket - 1);
    conversions.push_back(find_unit(unit).value());
    if (conversions.size() > 1)
      samples.channels.push_back({cell.substr(0, bracket), std::string(conversions.back().si_unit), 0.0, {}});
  }
  while (std::getline(stream, line)) {
    std::size_t column = 0;
    for (std::istringstream row(line); std::getline(row, cell, ','); ++column) {
      const double value = conversions[column].to_si(std::stod(cell));
      (column == 0 ? samples.time_s : samples.channels[column - 1].values).push_back(value);
    }
  }
  return samples;
}

/// The nominal asset of a plant.
inline AssetConfig nominal_asset(const std::string& model) {
  AssetConfig asset;
  asset.asset_id = "TEST";
  asset.model = model;
  const PlantDescription& plant = *find_plant(model).value();
  for (const auto& parameter : plant.parameters)
    asset.parameters[parameter.name] = {parameter.value, parameter.min, parameter.max, parameter.estimate};
  for (const auto& channel : plant.channels)
    if (!channel.input) asset.sensors[channel.name] = {channel.noise_std, channel.time_constant_s, 0.0, 0.0, 0.0};
  return asset;
}

}  // namespace sealwatch
