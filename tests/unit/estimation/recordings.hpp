// Recordings and assets for the estimation tests: the public data where it is there, and signals made by a few lines of
// code that share nothing with the library.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/time_series.hpp"
#include "sealwatch/model/plant_description.hpp"

namespace sealwatch::test {

/// The nominal asset of a plant: every parameter and sensor of its table.
[[nodiscard]] AssetConfig nominal_asset(const std::string& plant = "eha");

/// A clean CSV of docs/recordings.md; asserts that it can be read.
[[nodiscard]] TimeSeries read_recording(const std::filesystem::path& file);

/// SEALWATCH_SHARED_DATA / `relative`.
[[nodiscard]] std::filesystem::path shared_data(const std::string& relative);

/// All CSV files of a folder, sorted by name; none when the folder is absent.
[[nodiscard]] std::vector<std::filesystem::path> recordings_in(const std::filesystem::path& folder);

}  // namespace sealwatch::test
