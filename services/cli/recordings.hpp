// Reading the recordings that a command line names.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/recording.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "services/common/estimation/runaway.hpp"

namespace sealwatch::cli {

/// Says on standard error which columns the plant does not know; nothing where it knows all.
void tell_left_aside(const Recording& recording, const std::string& plant);

/// Says on standard error where the units of the map are not the log's.
void tell_warnings(const Recording& recording);

/// The recordings in `files`, each with the asset's id. A file that cannot be read, or that is of another asset, is
/// told on standard error.
[[nodiscard]] std::optional<std::vector<Recording>> read_recordings(const std::vector<std::string>& files,
                                                                    const AssetConfig& asset,
                                                                    const PlantDescription& plant);

/// Their files; "log.csv#2" for the second test of a file that holds several.
[[nodiscard]] std::vector<std::string> names_of(const std::vector<Recording>& recordings);

/// Warns on standard error where the first recording's simulation runs away by itself.
std::optional<Runaway> tell_runaway(const std::vector<Recording>& recordings, const AssetConfig& asset,
                                    const Deadline* deadline = nullptr);

}  // namespace sealwatch::cli
