// Numbers as people read them: sensible digits, with their unit.
#pragma once

#include <string>

namespace sealwatch::forecast {

/// 18.43 -> "18 months", 2.34 -> "2.3 months", 2.0 (an interval) -> "2 months", 1.0 -> "1 month".
[[nodiscard]] std::string in_months(double months);
/// 12.3 -> "12 days", 2.34 -> "2.3 days".
[[nodiscard]] std::string in_days(double days);
/// 0.1234 -> "12 %", 0.034 -> "3.4 %", 0.0001 -> "under 0.1 %", 0.9999 -> "over 99.9 %".
[[nodiscard]] std::string in_percent(double share);
/// 0.72345 -> "0.723": theta and its standard errors.
[[nodiscard]] std::string as_condition(double condition);
/// Value and standard error of theta: "0.7235 +- 0.0021".
[[nodiscard]] std::string condition_with_std(double condition, double condition_std);
/// 2.2e13 -> "2.20e+13": quantities over many orders of magnitude, three digits.
[[nodiscard]] std::string three_digits(double value);

}  // namespace sealwatch::forecast
