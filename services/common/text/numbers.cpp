#include "services/common/text/numbers.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "services/common/text/format.hpp"

namespace sealwatch::text {

std::string significant(double value, int digits) { return format("{:.{}g}", value, digits); }

std::string general(double value) { return number(value, 6); }

std::string number(double value, int digits) {
  constexpr double kLargest = 1e7;
  std::string text = significant(value, digits);
  const double size = std::abs(value);
  if (text.find('e') == std::string::npos || size < 1.0 || size >= kLargest) return text;
  double rounded = value;
  std::from_chars(text.data(), text.data() + text.size(), rounded);
  return format("{:.0f}", rounded);
}

std::string with_zeros(double value, int digits) {
  if (value == 0.0 || !std::isfinite(value)) return format("{:g}", value);
  const int exponent = static_cast<int>(std::floor(std::log10(std::abs(value))));
  if (exponent >= 6 || exponent < -3) return format("{:.{}e}", value, digits - 1);
  return format("{:.{}f}", value, std::max(digits - 1 - exponent, 0));
}

std::string exact(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::string percent(double share, int decimals) { return format("{:.{}f} %", 100.0 * share, decimals); }

std::string in_percent(double probability) {
  if (probability < 0.001) return "under 0.1 %";
  if (probability > 0.999) return "over 99.9 %";
  return percent(probability, 100.0 * probability < 9.95 || 100.0 * probability > 99.0 ? 1 : 0);
}

std::string in_months(double months) {
  if (months == 1.0) return "1 month";
  const bool whole = months == std::round(months);
  return format("{:.{}f} months", months, std::abs(months) < 10.0 && !whole ? 1 : 0);
}

std::string range_in_months(double low, double high) {
  const std::string from = in_months(low);
  return from.substr(0, from.find(' ')) + " to " + in_months(high);
}

std::string in_days(double days) { return format("{:.{}f} days", days, std::abs(days) < 10.0 ? 1 : 0); }

std::string as_condition(double condition) { return format("{:.3f}", condition); }

std::string condition_in_percent(double condition) { return percent(condition); }

std::string condition_with_std(double condition, double condition_std) {
  const std::string error = format("{:.1g}", 100.0 * condition_std);
  const int decimals = condition_std > 0.0 ? -static_cast<int>(std::floor(std::log10(100.0 * condition_std))) : 2;
  return format("{:.{}f} ± {} %", 100.0 * condition, std::clamp(decimals, 0, 6), error);
}

std::string spread_in_percent(double spread) { return format("{:.2g} %", 100.0 * spread); }

}  // namespace sealwatch::text
