#include "tests/unit/estimation/recordings.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <sstream>

#include "sealwatch/core/units.hpp"

namespace sealwatch::test {
namespace {

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

}  // namespace

AssetConfig nominal_asset(const std::string& plant) {
  const PlantDescription& table = **find_plant(plant);
  AssetConfig asset;
  asset.asset_id = "test";
  asset.model = plant;
  for (const ParameterDescription& parameter : table.parameters)
    asset.parameters[parameter.name] = {
        .value = parameter.value, .min = parameter.min, .max = parameter.max, .estimate = parameter.estimate};
  for (const ChannelDescription& channel : table.channels)
    asset.sensors[channel.name] = {.noise_std = channel.noise_std,
                                   .time_constant_s = channel.time_constant_s,
                                   .range_min = channel.range_min,
                                   .range_max = channel.range_max};
  asset.condition = ConditionSetting{
      .parameter = "R_CL", .at_100 = 2.6e13, .at_60 = 4.64e12, .unit = "Pa s/m3", .part = "piston seal"};
  return asset;
}

TimeSeries read_recording(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  TimeSeries samples;
  std::vector<UnitConversion> conversions;
  for (const std::string& cell : split(line)) {
    const std::size_t bracket = cell.find('[');
    const UnitConversion conversion = find_unit(cell.substr(bracket + 1, cell.find(']') - bracket - 1)).value();
    conversions.push_back(conversion);
    const std::string name = cell.substr(0, bracket);
    if (name != "time")
      samples.channels.push_back(
          {.name = name, .unit = std::string(conversion.si_unit), .noise_std = 0.0, .values = {}});
  }
  while (std::getline(stream, line)) {
    const std::vector<std::string> cells = split(line);
    samples.time_s.push_back(std::strtod(cells.at(0).c_str(), nullptr));
    for (std::size_t c = 1; c < cells.size(); ++c)
      samples.channels.at(c - 1).values.push_back(conversions.at(c).to_si(std::strtod(cells[c].c_str(), nullptr)));
  }
  return samples;
}

std::filesystem::path shared_data(const std::string& relative) {
  return std::filesystem::path(SEALWATCH_SHARED_DATA) / relative;
}

std::vector<std::filesystem::path> recordings_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code absent;
  for (const auto& entry : std::filesystem::directory_iterator(folder, absent))
    if (entry.path().extension() == ".csv") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace sealwatch::test
