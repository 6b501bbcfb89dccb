// Units at the border: everything inside sealwatch is SI; recordings may use the units of docs/recordings.md.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sealwatch/core/result.hpp"

namespace sealwatch {

/// si = value * scale + offset.
struct UnitConversion {
  double scale = 1.0;
  double offset = 0.0;
  std::string_view si_unit;  ///< the SI unit that the result is in: "Pa", "m3/s"
  [[nodiscard]] double to_si(double value) const { return value * scale + offset; }
};

/// Conversion of `unit` to SI; an Error with the nearest known unit when it is not known. "1" and "" are plain numbers.
[[nodiscard]] Result<UnitConversion> find_unit(std::string_view unit);

/// The units that can be converted to `si_unit`, itself first: "Pa", "bar", "MPa", ...
[[nodiscard]] std::vector<std::string> units_of(std::string_view si_unit);

}  // namespace sealwatch
