// How somebody's own log is to be read: which of its columns is which channel, in what unit, and how the file is laid
// out. Plain data; `channels:` and `log:` of an asset file, or of a file of their own (--map).
//
//   value of the channel [SI] = SI(unit, scale * number in the file + offset)
#pragma once

#include <map>
#include <string>

namespace sealwatch {

struct ColumnMapping {
  std::string column;  ///< header cell with or without its unit; of HDF5 the path of a data set
  std::string unit;  ///< "": as the header says, else SI. Of `time` also "iso8601", "excel" or a pattern "%d.%m.%Y %T"
  double scale = 1.0;   ///< [unit / 1] of one count
  double offset = 0.0;  ///< [unit]
  /// Scale or offset are said, if only as 1 and 0: the unit is then that of the scaled number, not the log's.
  bool is_scaled = false;
  bool operator==(const ColumnMapping&) const = default;
};

/// Rows are counted as an editor shows them, 1 for the first. 0 and "": found by looking at the file.
struct LogLayout {
  std::string delimiter;                   ///< "comma", "semicolon", "tab", "bar", "blank"
  std::string decimal;                     ///< "point", "comma"
  int header_row = 0;                      ///< what stands above it is no part of the table
  int units_row = 0;                       ///< a row of nothing but units
  int first_row = 0;                       ///< of numbers
  std::string time_resets = "refuse";      ///< "join": time goes on; "split": each begins another test
  std::string incomplete_rows = "refuse";  ///< "skip": a row with an empty cell is left out
  /// "jump": rows of one time are before and after a jump (repeated_times.hpp).
  std::string repeated_times = "refuse";
  bool operator==(const LogLayout&) const = default;
};

struct ChannelMap {
  std::map<std::string, ColumnMapping> columns;  ///< by channel, `time` among them; what is not named keeps its name
  LogLayout log;
  /// The format of docs/recordings.md.
  [[nodiscard]] bool empty() const {
    LogLayout own;
    own.repeated_times = log.repeated_times;
    return columns.empty() && log == own;
  }
  bool operator==(const ChannelMap&) const = default;
};

}  // namespace sealwatch
