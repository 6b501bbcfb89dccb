// Asset files (docs/asset-file.md): what is known of one actuator, as YAML.
//
//   asset_id: XT03-MV2
//   site: north_field            segment: XT03 master valve 2         model: eha
//   parameters: {R_CL: {value: 2.6e13, min: 2.6e12, max: 7.8e13, estimate: true}, f_C: 2.0e6}
//   sensors: {pressure_a: {noise_std: 1.0e4, time_constant: 0.005, quantisation: 0, range: [0, 6.0e7]}}
//   seal: {resistance_100: 2.6e13, resistance_60: 4.64e12, threshold: 0.60}
//   pst: {start: 0.060, stroke: -0.016, speed: 1.33e-3, hold: 3.0, interval_months: 1}
//   alert_limits: {friction_pressure: {advisory: 5.0e5, warning: 7.0e5, alarm: 9.0e5}}
//   channels: {pressure_a: {column: PT-101, unit: psig}}   log: {delimiter: semicolon}   (channel_map_file.hpp)
//   physics: [{id: stribeck_friction, element: piston, parameters: {F_s: 4000}}]
//
// Everything but asset_id may be left out and then takes the plant table's defaults. A parameter whose value lies
// outside the table's bounds and that gives none of its own gets a tenth to ten times that value. `seal: null` says
// that no seal condition is defined; plants other than `eha` have none unless it is given.
#pragma once

#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/result.hpp"

namespace sealwatch {

template <class T>
using Checked = tl::expected<T, std::vector<Error>>;

/// Reads and checks an asset file and names every fault with its line. `sites`: where given, the sites that there are.
[[nodiscard]] Checked<AssetConfig> check_asset(const std::string& file,
                                               const std::vector<std::string>* sites = nullptr);

/// The same with all faults in one Error.
[[nodiscard]] Result<AssetConfig> load_asset(const std::string& file);

/// The asset as a file that load_asset reads back to the same values.
[[nodiscard]] std::string asset_to_yaml(const AssetConfig& asset);
[[nodiscard]] Status save_asset(const AssetConfig& asset, const std::string& file);

/// Several faults as one: the first one's, and the others' descriptions, one a line.
[[nodiscard]] Error combine(const std::vector<Error>& errors);

}  // namespace sealwatch
