// Recordings on disk (INTERFACES section 1): NAME.csv or NAME.mat, with an optional sidecar NAME.yaml.
//
// Rows are counted as an editor shows them: row 1 is the header, row 2 the first sample (in a MAT file row 1 is the
// first element of a vector). Whatever breaks a rule is an Error that names file, row and column, or the sidecar's
// line and key; a recording is returned whole or not at all.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "sealwatch/core/recording.hpp"
#include "sealwatch/core/result.hpp"
#include "sealwatch/model/plant_description.hpp"

namespace sealwatch {

/// A recording of more numbers (samples times channels) than this is refused while it is being read: 160 MB in memory,
/// about nine hours of all channels at 50 Hz, while a partial stroke test has some 10^5.
inline constexpr std::size_t kMostNumbers = 20'000'000;
/// A row longer than this is refused: it is no row of numbers.
inline constexpr std::size_t kLongestRow_bytes = std::size_t{1} << 20U;
/// A sidecar longer than this is refused.
inline constexpr std::size_t kLongestSidecar_bytes = std::size_t{1} << 16U;

/// Reads `path`, a .mat file by its suffix and else CSV, and its sidecar where there is one.
///
/// `content_hash` covers the bytes of the data file alone: mending a note or a start time in the sidecar does not make
/// another recording of it.
[[nodiscard]] Result<Recording> read_recording(const std::string& path, const PlantDescription& plant);

/// ".csv" or ".mat" in small letters, as `path` ends: Windows writes them in capitals, too.
[[nodiscard]] std::string suffix_of(const std::string& path);

/// The asset that the sidecar of `path` names, "" when there is none: with it the caller finds the plant to read with.
[[nodiscard]] Result<std::string> recorded_asset_id(const std::string& path);

/// The start time that the sidecar of `path` gives; nothing where there is none or it cannot be read.
[[nodiscard]] std::optional<UtcTime> recorded_start_time(const std::string& path);

/// All digits that it takes to read back the very same double.
inline constexpr int kExactDigits = 0;

/// Writes `path` (a .csv) and its sidecar; the sidecar first and each under its final name only when complete, so that
/// who watches the folder never sees a half. Units are SI. `significant_digits` rounds the values.
[[nodiscard]] Status write_recording_csv(const Recording& recording, const std::string& path,
                                         int significant_digits = kExactDigits);

}  // namespace sealwatch
