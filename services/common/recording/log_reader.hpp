// Somebody's own log, read by a channel map (config/channel_map.hpp) into samples in SI units.
//
// A channel that the map names comes from that column; of the other columns those that are called as a channel of the
// plant are taken, `channel[unit]`, and the rest is left aside. One file may hold several tests: each time the time
// column starts anew, where the map says that this begins another.
#pragma once

#include <istream>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/config/channel_map.hpp"
#include "sealwatch/core/time.hpp"
#include "services/common/recording/columns.hpp"
#include "services/common/recording/log_layout.hpp"

namespace sealwatch {

struct LogTest {
  ColumnarSamples read;
  std::optional<UtcTime> start_time;  ///< where the time column tells day and hour
  std::optional<UtcTime> clock = {};  ///< the same of a time column that tells the hour alone, on 1970-01-01
  std::size_t first_row = 1;          ///< of the file, where its first sample stands
};

struct Log {
  std::vector<LogTest> tests;
  std::vector<std::string> left_aside;     ///< header cells
  std::vector<std::string> warnings = {};  ///< see MappedColumns
};

/// The header cells of a log, after its layout; `in` is left where it was.
[[nodiscard]] Result<FoundLayout> layout_of(std::istream& in, const LogLayout& given);

/// Whether the log has a column that the map names: one that has none may be in the project's own format.
[[nodiscard]] bool has_a_column_of(const FoundLayout& layout, const ChannelMap& map);

/// Reads the whole stream. Errors name row and column, not the file.
[[nodiscard]] Result<Log> read_log(std::istream& in, const PlantDescription& plant, const ChannelMap& map);

}  // namespace sealwatch
