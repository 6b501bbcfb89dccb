// Recordings on disk (docs/recordings.md): NAME.csv or NAME.mat, with an optional sidecar NAME.yaml; or somebody's own
// log, read by a channel map (docs/logs.md).
//
// Rows are counted as an editor shows them: row 1 is the header, row 2 the first sample (in a MAT file row 1 is the
// first element of a vector). Whatever breaks a rule is an Error that names file, row and column, or the sidecar's
// line and key; a recording is returned whole or not at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/config/channel_map.hpp"
#include "sealwatch/core/recording.hpp"
#include "sealwatch/core/result.hpp"
#include "sealwatch/core/test_limits.hpp"
#include "sealwatch/model/plant_description.hpp"

namespace sealwatch {

/// A recording of more numbers (samples times channels) than one test may have is refused while it is being read.
inline constexpr std::size_t kMostNumbers = kTestLimits.most_numbers;
/// A larger file holds more than one test: the numbers of one, written with all digits, fill a hundredth of it.
inline constexpr std::uint64_t kLargestRecording_bytes = 4'000'000'000;
/// A row longer than this is refused: it is no row of numbers.
inline constexpr std::size_t kLongestRow_bytes = std::size_t{1} << 20U;
/// A sidecar longer than this is refused.
inline constexpr std::size_t kLongestSidecar_bytes = std::size_t{1} << 16U;

/// Reads the tests in `path`, by its suffix a .mat or .h5 file and else text, with its sidecar where there is one. `map`
/// says how somebody's own log is written; a file of the project's own format needs none. "A.csv+B.csv": files of one
/// test, one after the other; the sidecar is the first's.
///
/// `content_hash` covers the bytes of the data files alone: mending a note or a start time in the sidecar does not make
/// another recording of it.
[[nodiscard]] Result<std::vector<Recording>> read_recordings(const std::string& path, const PlantDescription& plant,
                                                             const ChannelMap& map = {});

/// The one test in `path`; an Error where there are several.
[[nodiscard]] Result<Recording> read_recording(const std::string& path, const PlantDescription& plant,
                                               const ChannelMap& map = {});

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
