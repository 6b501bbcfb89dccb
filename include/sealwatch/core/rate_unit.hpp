// Unit of a rate of change: of a position in m that is m/s, of a speed in m/s that is m/s2.
#pragma once

#include <string>
#include <string_view>

namespace sealwatch {

/// That of the derivative in time of what has this unit: "Pa/s", "1/s" of a plain number, "(kg/m)/s" of any quotient.
[[nodiscard]] inline std::string rate_unit(std::string_view unit) {
  const std::string text(unit.empty() ? "1" : unit);
  if (text.ends_with("/s")) return text + "2";
  if (text.find('/') != std::string::npos) return "(" + text + ")/s";
  return text + "/s";
}

}  // namespace sealwatch
