// Numbers in plain text, with as many digits as mean something. For pages and screens with Unicode: readable.hpp.
#pragma once

#include <string>
#include <string_view>

namespace sealwatch::text {

/// At most `digits` significant digits: "2.61e+13", "0.0213", "12.3".
[[nodiscard]] std::string significant(double value, int digits = 3);
/// Six digits, as settings are shown: "1e-05", "0.0859437".
[[nodiscard]] std::string general(double value);
/// At most `digits` without an exponent from 1 to 1e7, as engineers read it: 64400, not 6.44e+04.
[[nodiscard]] std::string number(double value, int digits = 3);
/// The same with trailing zeros, for columns: "1.230"; an exponent from 1e6 on and below 0.001.
[[nodiscard]] std::string with_zeros(double value, int digits = 4);
/// The shortest text that reads back as the same number: "0.1", "1e-07".
[[nodiscard]] std::string exact(double value);

/// A share: "12.3 %".
[[nodiscard]] std::string percent(double share, int decimals = 1);
/// A probability: 0.1234 -> "12 %", 0.034 -> "3.4 %"; never certain: 0 -> "under 0.1 %", 0.9999 -> "over 99.9 %".
[[nodiscard]] std::string in_percent(double probability);

/// 18.43 -> "18 months", 2.34 -> "2.3 months", 2.0 (an interval) -> "2 months", 1.0 -> "1 month".
[[nodiscard]] std::string in_months(double months);
/// "34.6", "39.1" -> "35 to 39 months".
[[nodiscard]] std::string range_in_months(double low, double high);
/// 12.3 -> "12 days", 2.34 -> "2.3 days".
[[nodiscard]] std::string in_days(double days);

/// 0.72345 -> "0.723": theta and its standard errors.
[[nodiscard]] std::string as_condition(double condition);
/// 0.667 -> "66.7 %": the seal condition as on operators' screens.
[[nodiscard]] std::string condition_in_percent(double condition);
/// Seal condition and its standard error, as many decimals as that has: "72.4 ± 0.2 %".
[[nodiscard]] std::string condition_with_std(double condition, double condition_std);
/// How far estimates of it scatter: 0.00123 -> "0.12 %".
[[nodiscard]] std::string spread_in_percent(double spread);

}  // namespace sealwatch::text
