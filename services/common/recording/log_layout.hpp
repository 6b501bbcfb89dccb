// How a log is laid out: found from its first rows where nobody says it.
//
// Delimiter and decimal sign are those that make the most cells of the rows numbers or times; the table begins at the
// first of the rows that have the commonest number of cells, and the rows above it are header and units, in either order.
// What stands above those is preamble, numbers behind a name among it; a row there that is called units is that.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "sealwatch/config/channel_map.hpp"
#include "sealwatch/core/result.hpp"
#include "services/common/recording/thousands.hpp"

namespace sealwatch {

struct FoundLayout {
  char delimiter = ',';
  char decimal = '.';
  DecimalSign decimal_sign = DecimalSign::likely;
  std::size_t header_row = 1;  ///< 0: none, columns are then called "column 1", "column 2"
  std::size_t units_row = 0;   ///< 0: none
  std::size_t first_row = 2;
  std::vector<std::string> header;  ///< UTF-8, one a column
  std::vector<std::string> units;   ///< as many; "" where none is said
};

/// `head`: the file's first bytes, some 100 kB or all of it. What `given` says is taken as it is. Errors name a row.
[[nodiscard]] Result<FoundLayout> find_layout(std::string_view head, const LogLayout& given);

/// A header cell in one line, UTF-8.
[[nodiscard]] std::string header_text(std::string_view cell);

/// Whether a row is the table's header, or its units, once more: loggers write both above each block.
[[nodiscard]] bool repeats_head(const FoundLayout& layout, const std::vector<std::string_view>& cells);

/// The rows of `head` from `first_row` on, some `most`, as cells. One of several lines, with line breaks in quotes, is
/// its first line; its others are blank rows.
[[nodiscard]] std::vector<std::vector<std::string>> rows_of(std::string_view head, char delimiter,
                                                            std::size_t first_row, std::size_t most);

/// "PT-101 [psig]", "PT-101 (psig)", "PT-101 / psig": name and unit; the unit is "" where the text behind is none.
struct NameAndUnitText {
  std::string name;
  std::string unit;
};
[[nodiscard]] NameAndUnitText split_header_cell(std::string_view cell);

/// How a time column counts, from some of its cells: "iso8601", a pattern of strptime; "" where they are numbers.
[[nodiscard]] std::string time_format_of(const std::vector<std::string>& cells);

/// Text of Windows' Western code page as UTF-8, UTF-8 as it is; what a terminal would obey, or nobody sees, as "\xHH".
[[nodiscard]] std::string as_utf8(std::string_view text);

}  // namespace sealwatch
