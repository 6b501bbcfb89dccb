// Numbers as people read them: sensible digits, with their unit.
#pragma once

#include <string>
#include <string_view>

namespace sealwatch::forecast {

/// 18.43 -> "18 months", 2.34 -> "2.3 months", 2.0 (an interval) -> "2 months", 1.0 -> "1 month".
[[nodiscard]] std::string in_months(double months);
/// 12.3 -> "12 days", 2.34 -> "2.3 days".
[[nodiscard]] std::string in_days(double days);
/// 0.1234 -> "12 %", 0.034 -> "3.4 %", 0.0001 -> "under 0.1 %", 0.9999 -> "over 99.9 %".
[[nodiscard]] std::string in_percent(double share);
/// 0.72345 -> "0.723": theta and its standard errors.
[[nodiscard]] std::string as_condition(double condition);
/// 0.667 -> "66.7 %": the seal condition as on operators' screens.
[[nodiscard]] std::string condition_in_percent(double condition);
/// Seal condition and its standard error: "72.35 +- 0.2 %".
[[nodiscard]] std::string condition_with_std(double condition, double condition_std);
/// How far estimates of it scatter: 0.00123 -> "0.12 %".
[[nodiscard]] std::string spread_in_percent(double spread);
/// 2.2e13 -> "2.20e+13": quantities over many orders of magnitude, three digits.
[[nodiscard]] std::string three_digits(double value);
/// Names of states and quantities in sentences: "not_judged" -> "not judged".
[[nodiscard]] std::string in_words(std::string_view name);
/// 5.91e12, "Pa s/m3" -> "5.91e+12 Pa s/m3"; a unit of "1" (a plain number) is not named.
[[nodiscard]] std::string with_unit(double value, std::string_view unit);

}  // namespace sealwatch::forecast
