// The whole configuration from YAML: sealwatch.yaml and the asset files it names, checked as a whole before anything
// starts. Reference of all keys: docs/operations.md.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/config/configuration.hpp"
#include "services/common/runtime/asset_file.hpp"

namespace sealwatch {

/// What a command line may say instead of the file.
struct ConfigurationOverrides {
  std::optional<std::string> state_directory = {};
  std::optional<std::int32_t> domain = {};
  std::optional<UtcTime> now = {};  ///< then what the file says has happened must be before it
};

/// `path` is sealwatch.yaml or the directory that holds it. Asset files are found relative to it: those named under
/// `assets:`, else all of "assets/*.yaml". All faults of all files are returned, in the files' order.
[[nodiscard]] Checked<Configuration> load_configuration(const std::string& path,
                                                        const ConfigurationOverrides& overrides = {});

/// "line 3, key services.state_detection.journal": where a key stands in the file of `path`; without the line where it
/// does not stand there.
[[nodiscard]] std::string place_in_configuration(const std::string& path, const std::string& key);

/// The six services, in the order of the layers.
[[nodiscard]] const std::vector<std::string>& service_names();

/// What gives the same for each asset, without any asset but this.
[[nodiscard]] std::function<Configuration(const std::string& asset_id)> configurations_of_assets(
    const Configuration& configuration);

}  // namespace sealwatch
