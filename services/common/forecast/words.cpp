#include "sealwatch/forecast/words.hpp"

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

std::string condition_with_std(double condition, double condition_std) {
  return print("%.4f", condition) + " +- " + print(condition_std < 1e-4 ? "%.0e" : "%.4f", condition_std);
}

std::string three_digits(double value) { return print("%.2e", value); }

}  // namespace sealwatch::forecast
