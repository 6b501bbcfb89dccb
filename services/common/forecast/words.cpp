#include "sealwatch/forecast/words.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace sealwatch::forecast {
namespace {

std::string print(const char* form, double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), form, value);
  return text.data();
}

}  // namespace

std::string in_months(double months) {
  if (months == 1.0) return "1 month";
  const bool whole = months == std::round(months);
  return print(std::abs(months) < 10.0 && !whole ? "%.1f months" : "%.0f months", months);
}

std::string in_days(double days) { return print(std::abs(days) < 10.0 ? "%.1f days" : "%.0f days", days); }

std::string in_percent(double share) {
  if (share < 0.001) return "under 0.1 %";
  if (share > 0.999) return "over 99.9 %";
  const double percent = 100.0 * share;
  return print(percent < 9.95 || percent > 99.0 ? "%.1f %%" : "%.0f %%", percent);
}

std::string as_condition(double condition) { return print("%.3f", condition); }

std::string condition_in_percent(double condition) { return print("%.1f %%", 100.0 * condition); }

std::string condition_with_std(double condition, double condition_std) {
  return print("%.2f", 100.0 * condition) + " +- " + print("%.1g %%", 100.0 * condition_std);
}

std::string spread_in_percent(double spread) { return print("%.2g %%", 100.0 * spread); }

std::string in_words(std::string_view name) {
  std::string text(name);
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

std::string with_unit(double value, std::string_view unit) {
  std::string text = print("%.3g", value);
  if (unit != "1" && !unit.empty()) text.append(" ").append(unit);
  return text;
}

std::string three_digits(double value) { return print("%.2e", value); }

}  // namespace sealwatch::forecast
