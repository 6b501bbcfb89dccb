#include "sealwatch/core/units.hpp"

#include <array>
#include <numbers>
#include <string>
#include <vector>

#include "sealwatch/core/text.hpp"

namespace sealwatch {
namespace {

struct KnownUnit {
  std::string_view name;
  UnitConversion conversion;
};

constexpr double kRevolution = 2.0 * std::numbers::pi;

// SI units first, then those of docs/recordings.md with their definitions.
constexpr std::array kUnits = {
    KnownUnit{"1", {1.0, 0.0, "1"}},
    KnownUnit{"s", {1.0, 0.0, "s"}},
    KnownUnit{"V", {1.0, 0.0, "V"}},
    KnownUnit{"A", {1.0, 0.0, "A"}},
    KnownUnit{"rad", {1.0, 0.0, "rad"}},
    KnownUnit{"rad/s", {1.0, 0.0, "rad/s"}},
    KnownUnit{"Pa", {1.0, 0.0, "Pa"}},
    KnownUnit{"m", {1.0, 0.0, "m"}},
    KnownUnit{"m/s", {1.0, 0.0, "m/s"}},
    KnownUnit{"m3/s", {1.0, 0.0, "m3/s"}},
    KnownUnit{"N", {1.0, 0.0, "N"}},
    KnownUnit{"K", {1.0, 0.0, "K"}},
    KnownUnit{"bar", {1.0e5, 0.0, "Pa"}},
    KnownUnit{"MPa", {1.0e6, 0.0, "Pa"}},
    KnownUnit{"kPa", {1.0e3, 0.0, "Pa"}},
    KnownUnit{"psi", {6894.757293168361, 0.0, "Pa"}},
    KnownUnit{"mm", {1.0e-3, 0.0, "m"}},
    KnownUnit{"mm/s", {1.0e-3, 0.0, "m/s"}},
    KnownUnit{"L/min", {1.0e-3 / 60.0, 0.0, "m3/s"}},
    KnownUnit{"rpm", {kRevolution / 60.0, 0.0, "rad/s"}},
    KnownUnit{"rev", {kRevolution, 0.0, "rad"}},
    KnownUnit{"deg", {kRevolution / 360.0, 0.0, "rad"}},
    KnownUnit{"degC", {1.0, 273.15, "K"}},
    KnownUnit{"mA", {1.0e-3, 0.0, "A"}},
    KnownUnit{"ms", {1.0e-3, 0.0, "s"}},
    KnownUnit{"kN", {1.0e3, 0.0, "N"}},
};

}  // namespace

std::vector<std::string> units_of(std::string_view si_unit) {
  std::vector<std::string> names{std::string(si_unit)};
  for (const KnownUnit& known : kUnits)
    if (known.conversion.si_unit == si_unit && known.name != si_unit) names.emplace_back(known.name);
  return names;
}

Result<UnitConversion> find_unit(std::string_view unit) {
  if (unit.empty()) unit = "1";
  std::vector<std::string> names;
  for (const KnownUnit& known : kUnits) {
    if (known.name == unit) return known.conversion;
    names.emplace_back(known.name);
  }
  return fail(Error{.file = {},
                    .place = {},
                    .value = std::string(unit),
                    .rule = "is not a known unit",
                    .advice = suggest(unit, names)});
}

}  // namespace sealwatch
