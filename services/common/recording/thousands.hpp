// Numbers whose digits are grouped by thousands, as people and spreadsheets write them: 1,234.5, 1.234,5, 1'234.5 and
// 1 234,5. "1,234" alone may as well be 1.234: it is one of them only where the decimal sign is known to be the point.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace sealwatch {

/// Whether the decimal sign that a table is read with is known, from it or by the map, only likely, or may as well
/// separate thousands: "500" and "1,000" stand in one column, and nothing else tells.
enum class DecimalSign { doubtful, likely, known };

/// `text` without its separators of thousands: a number, then; nothing where it has none, or where they may be decimal
/// signs. `decimal` is '.' or ','.
[[nodiscard]] std::optional<std::string> without_thousands(std::string_view text, char decimal, DecimalSign sign);

/// Whether `cell` is a number with this decimal sign, and another one where the sign separates its thousands: "1,000".
[[nodiscard]] bool may_have_thousands(std::string_view cell, char decimal);

/// Whether `cell` is a number with this decimal sign, and cannot be one whose thousands that sign separates: "0.5".
[[nodiscard]] bool shows_decimal_sign(std::string_view cell, char decimal);

}  // namespace sealwatch
