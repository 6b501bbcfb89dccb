// Channels of a recording as a file names them: "pressure_a[bar]" becomes the plant's channel and a conversion to SI.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sealwatch/core/result.hpp"
#include "sealwatch/core/time_series.hpp"
#include "sealwatch/core/units.hpp"
#include "sealwatch/model/plant_description.hpp"

namespace sealwatch {

struct Column {
  std::string name;  ///< of an unknown one: its header cell
  std::string si_unit;
  UnitConversion to_si;
  bool known = true;  ///< to the plant; what is not is left aside, and its cells may be anything
};

inline constexpr const char* kRepeatAdvice =
    "take one of the rows out, or log a finer time; log: {repeated_times: jump} takes them as before and after a jump";

/// Samples and, one for each of their channels, the columns that they came from.
struct ColumnarSamples {
  TimeSeries samples;
  std::vector<Column> columns;
  std::vector<std::string> left_aside = {};  ///< header cells of unknown columns
  std::string content_hash;
};

/// Whether `text` is UTF-8, as everything that goes into messages must be.
[[nodiscard]] bool is_utf8(std::string_view text);

/// `text` as fit to be printed: where it is no visible UTF-8, all but printable ASCII replaced by '?'; at most
/// 60 bytes.
[[nodiscard]] std::string printable(std::string_view text);

/// An error at a place of a file that the caller names.
[[nodiscard]] Error error_at(std::string place, std::string_view value, std::string rule, std::string advice = {});

/// The column of a header cell "channel[unit]" (no unit: SI). An Error, which names no place, where it is nearly a
/// known name (nearest() in core/text.hpp): a typing error would otherwise lose a channel.
[[nodiscard]] Result<Column> find_column(std::string_view cell, const PlantDescription& plant);

/// All columns of a header; an Error in row 1 when one is mistyped or there twice, or time is missing.
[[nodiscard]] Result<std::vector<Column>> find_columns(std::span<const std::string_view> cells,
                                                       const PlantDescription& plant);

/// Splits `values`, one vector per column, into time and known channels in the order of the file.
[[nodiscard]] ColumnarSamples assemble(std::vector<Column> columns, std::vector<std::vector<double>> values);

}  // namespace sealwatch
