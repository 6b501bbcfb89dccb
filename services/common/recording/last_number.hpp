// Tells a last line that is cut off inside its last number from one that lacks no more than its line break: the rows
// before have as many decimals at least.
#pragma once

#include <algorithm>
#include <optional>
#include <string_view>

#include "services/common/recording/cells.hpp"

namespace sealwatch {

inline constexpr const char* kCutNumber = "the last line is cut off inside this number";
inline constexpr const char* kWholeRow = "the file must end with a whole row";

class LastNumber {
 public:
  /// Of each row in turn its last cell; true only of a row without a line break.
  [[nodiscard]] bool is_cut(std::string_view cell, char decimal, bool has_line_break) {
    const std::size_t count = decimals(trim(cell), decimal);
    const bool cut = !has_line_break && fewest_decimals_ && count < *fewest_decimals_;
    fewest_decimals_ = std::min(fewest_decimals_.value_or(count), count);
    return cut;
  }

 private:
  /// Characters after the decimal sign, exponent included.
  static std::size_t decimals(std::string_view number, char decimal) {
    const std::size_t sign = number.rfind(decimal);
    return sign == std::string_view::npos ? 0 : number.size() - sign - 1;
  }

  std::optional<std::size_t> fewest_decimals_;
};

}  // namespace sealwatch
