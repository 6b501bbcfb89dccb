// Numbers and units as an engineer reads them: SI inside, bar, mm, L/min, rpm and powers of ten in writing.
#pragma once

#include <string>
#include <string_view>

namespace sealwatch::text {

/// shown = SI value * factor, in `text`.
struct DisplayUnit {
  double factor = 1.0;
  std::string text;  ///< UTF-8, "bar", "10¹² Pa·s/m³"; empty for a plain number
};

/// The unit in which values up to `magnitude` (absolute, SI) of unit `si_unit` read best: 1.2e7 Pa as bar, 3e-5 m as
/// µm. A unit without everyday ones keeps its name, with a power of ten where the number needs one.
[[nodiscard]] DisplayUnit display_unit(std::string_view si_unit, double magnitude);

/// "m3/s" as "m³/s", "Pa s/m3" as "Pa·s/m³", "1" as "".
[[nodiscard]] std::string unit_text(std::string_view si_unit);

/// `value` with `digits` significant digits, trailing zeros kept: "0.0123", "4010", "2.60·10¹³". Not a number: "–".
[[nodiscard]] std::string number_text(double value, int digits = 3);

/// At most `digits` significant digits in a sentence: "64400", "2.6·10¹³", "5·10⁻⁵".
[[nodiscard]] std::string in_sentence(double value, int digits = 3);

/// The same with its SI unit, beside limits in that unit: "5.91·10¹² Pa·s/m³"; a plain number ("1") has none.
[[nodiscard]] std::string with_unit(double value, std::string_view si_unit, int digits = 3);

/// Value in its everyday unit: readable(1.05e7, "Pa") = "105 bar".
[[nodiscard]] std::string readable(double value, std::string_view si_unit, int digits = 3);

/// Value with its standard error, as many decimals as the error's second digit: "(2.580 ± 0.030)·10¹³ Pa·s/m³". Without
/// a unit ("") the number is not scaled.
[[nodiscard]] std::string readable_with_error(double value, double error, std::string_view si_unit);

/// A share as percentage, "97 %", "0.4 %"; never "100 %" or "0 %" for what is neither.
[[nodiscard]] std::string percent_text(double share);

/// A p-value: "0.23", "< 10⁻⁹" at the least.
[[nodiscard]] std::string p_value_text(double p);

}  // namespace sealwatch::text
