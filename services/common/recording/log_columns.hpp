// Which columns of a table are which channels, by a channel map: of a log's header, or of the vectors of a MATLAB or
// HDF5 file.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sealwatch/config/channel_map.hpp"
#include "services/common/recording/cells.hpp"
#include "services/common/recording/columns.hpp"

namespace sealwatch {

/// A column as a file offers it.
struct OfferedColumn {
  std::string text;       ///< header cell, UTF-8
  std::string unit = {};  ///< said beside it, in a row of units or an attribute
};

/// Between the columns that a time is read from, where a log has them apart: "Date + Time", "Time + ms", or all three.
inline constexpr std::string_view kDayAndTime = " + ";

/// Of a time that no column holds: the rows are counted.
inline constexpr std::string_view kCountOfRows = "row";
inline constexpr std::size_t kNoColumn = static_cast<std::size_t>(-1);

struct MappedColumn {
  std::size_t index = 0;  ///< of the offered columns; kNoColumn: the count of rows
  Column column;          ///< of `time` to_si is not used: see `time_unit`
};

struct MappedColumns {
  std::vector<MappedColumn> columns;  ///< each channel once, `time` among them
  std::string time_unit;              ///< for TimeFormat, as are:
  double time_scale = 1.0, time_offset = 0.0;
  std::optional<std::size_t> day;       ///< the offered column that stands before the time's cell, with a blank between
  std::optional<std::size_t> fraction;  ///< the offered column whose number is added to the time
  double fraction_to_s = 0.0;
  std::vector<std::string> left_aside;
  std::vector<std::string> warnings = {};  ///< of columns whose unit is another in the map than in the log
};

/// "column 2": what a column without a header is called, and one that shares its header with another may be.
[[nodiscard]] std::string place_name(std::size_t index);

/// What a column's unit is: said beside it, or in its text by split_header_cell(); "" where neither.
[[nodiscard]] std::string unit_of(const OfferedColumn& column);

/// The unit at the end of a name, "t_ms", "Speed rpm", where it is one of `si_unit`'s quantity and no letter, which may be
/// a chamber's; "%" and "counts" of any quantity, which are to be refused without a scale. Behind a slash, "U/V", or in
/// brackets that something follows, "Stroke (mm) - raw", or that go on, "Zeit (s seit Start)", a letter too. "" where there is none.
[[nodiscard]] std::string unit_at_the_end(std::string_view text, const std::string& si_unit);

/// How many seconds one of a column's numbers is, where the column says a unit of time: beside it, at its end or as its
/// name, as ms, Milliseconds and nsecs do.
[[nodiscard]] std::optional<double> seconds_of_one(const OfferedColumn& column);

/// How the time column counts.
[[nodiscard]] Result<TimeFormat> time_format(const MappedColumns& mapped);

/// Errors name the channel, not the place.
[[nodiscard]] Result<MappedColumns> map_columns(const std::vector<OfferedColumn>& offered,
                                                const PlantDescription& plant, const ChannelMap& map);

/// The offered column that a mapping means: its text, or its text without the unit; then with small for capital letters;
/// then its place.
[[nodiscard]] Result<std::size_t> find_offered(const std::vector<OfferedColumn>& offered, const std::string& wanted);

}  // namespace sealwatch
