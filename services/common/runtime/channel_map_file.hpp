// `channels:` and `log:` of an asset file, or of a file of their own (--map): how somebody's own log is to be read.
//
//   channels:
//     time: {column: Timestamp, unit: iso8601}           # or excel, s, ms, min, "%d.%m.%Y %H:%M:%S"
//     pressure_a: PT-101 [psig]                          # the unit stands in the header
//     position: {column: LVDT, unit: mm, scale: 0.0122, offset: -25}    # mm = 0.0122 counts - 25
//   log: {delimiter: semicolon, decimal: comma, header_row: 12}         # what is not given is found
#pragma once

#include <string>

#include "sealwatch/config/channel_map.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "services/common/runtime/yaml_map.hpp"

namespace sealwatch {

/// Reads both keys. `plant`: whose channels may be named; none: any.
void read_channel_map(YamlMap& map, const PlantDescription* plant, ChannelMap& target);

/// The map in a file that holds nothing else; every fault with its line.
[[nodiscard]] Checked<ChannelMap> check_channel_map(const std::string& file, const PlantDescription* plant);

/// Both keys as YAML that reads back to the same values; "" for an empty map.
[[nodiscard]] std::string channel_map_to_yaml(const ChannelMap& map);

}  // namespace sealwatch
