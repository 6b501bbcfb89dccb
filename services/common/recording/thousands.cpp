#include "services/common/recording/thousands.hpp"

#include <algorithm>
#include <array>

#include "services/common/recording/cells.hpp"

namespace sealwatch {
namespace {

constexpr std::size_t kGroup = 3;  // digits between two separators

/// Point, comma, apostrophe, blank and their kin: no-break (in UTF-8 and Windows' code page), narrow, thin, typographic.
constexpr std::array<std::string_view, 9> kSeparators = {
    ".", ",", "'", " ", "\xC2\xA0", "\xE2\x80\xAF", "\xE2\x80\x89", "\xE2\x80\x99", "\xA0"};

bool is_decimal_digit(char letter) { return letter >= '0' && letter <= '9'; }

std::size_t digits_at_begin(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::find_if_not(text, is_decimal_digit) - text.begin());
}

/// The separator that a group of digits follows; "": none does.
std::string_view separator_of(std::string_view text, char decimal) {
  for (const std::string_view separator : kSeparators)
    if (separator.front() != decimal && text.starts_with(separator) &&
        digits_at_begin(text.substr(separator.size())) == kGroup)
      return separator;
  return {};
}

struct Grouped {
  std::string digits;  ///< of the whole part, without separators
  std::string_view separator;
  std::string_view rest;   ///< behind the whole part
  std::size_t groups = 0;  ///< behind the first
};

std::optional<Grouped> grouped(std::string_view text, char decimal) {
  const std::size_t first = digits_at_begin(text);
  if (first == 0 || first > kGroup || text.front() == '0') return std::nullopt;
  Grouped found{.digits = std::string(text.substr(0, first)),
                .separator = separator_of(text.substr(first), decimal),
                .rest = text.substr(first)};
  if (found.separator.empty()) return std::nullopt;
  for (; separator_of(found.rest, decimal) == found.separator; ++found.groups) {
    found.digits.append(found.rest.substr(found.separator.size(), kGroup));
    found.rest.remove_prefix(found.separator.size() + kGroup);
  }
  return found;
}

}  // namespace

std::optional<std::string> without_thousands(std::string_view text, char decimal, DecimalSign sign) {
  text = trim(text);
  constexpr std::string_view kMinus = "\xE2\x88\x92";  // U+2212
  std::string out;
  if (text.starts_with(kMinus))
    out = "-", text.remove_prefix(kMinus.size());
  else if (text.starts_with('-') || text.starts_with('+'))
    out = text.front(), text.remove_prefix(1);
  const std::optional<Grouped> found = grouped(text, decimal);
  if (!found) return std::nullopt;
  const bool is_point_or_comma = found->separator == "." || found->separator == ",";
  const bool may_be_decimal = is_point_or_comma && found->groups == 1 && !found->rest.starts_with(decimal);
  if (may_be_decimal && sign != DecimalSign::known) return std::nullopt;
  out.append(found->digits).append(found->rest);
  return parse_number(out, decimal) ? std::optional(out) : std::nullopt;
}

bool may_have_thousands(std::string_view cell, char decimal) {
  return cell.find(decimal) != std::string_view::npos &&
         without_thousands(cell, decimal == '.' ? ',' : '.', DecimalSign::known);
}

bool shows_decimal_sign(std::string_view cell, char decimal) {
  if (cell.find(decimal) == std::string_view::npos || may_have_thousands(cell, decimal)) return false;
  return parse_number(cell, decimal) || without_thousands(cell, decimal, DecimalSign::likely);
}

}  // namespace sealwatch
