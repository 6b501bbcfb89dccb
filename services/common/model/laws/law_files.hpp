// What every law file includes. A law is one file here: laws/NAME.cpp defines `Law NAME()`; where several forms share
// an id, each has a file. The build makes the catalogue from the file names. docs/laws.md shows how to add one.
#pragma once

#include <cmath>
#include <utility>

#include "sealwatch/model/laws.hpp"
#include "sealwatch/model/physics.hpp"

namespace sealwatch::laws {

struct StrengthSize {
  double usual = 0.0;
  double significant = 0.0;
  double max = 0.0;
  bool either_sign = false;  ///< min = -max; else min = 0
};

/// A parameter to which the contribution is proportional.
[[nodiscard]] inline LawParameter strength(std::string_view name, std::string_view unit, std::string_view meaning,
                                           const StrengthSize& size) {
  return {.name = name,
          .unit = unit,
          .meaning = meaning,
          .start = {size.usual},
          .min = size.either_sign ? -size.max : 0.0,
          .max = size.max,
          .strength = true,
          .significant = size.significant};
}

/// A parameter that the contribution follows in a curve, with the grid on which it is searched (the first is usual).
[[nodiscard]] inline LawParameter shape(std::string_view name, std::string_view unit, std::string_view meaning,
                                        std::vector<double> grid, double min, double max) {
  return {.name = name, .unit = unit, .meaning = meaning, .start = std::move(grid), .min = min, .max = max};
}

/// Around which position something acts. (A step below zero is a constant force for all else: it stays above.)
[[nodiscard]] inline LawParameter place(std::string_view name, std::vector<double> grid) {
  return {.name = name,
          .unit = "m",
          .meaning = "position",
          .start = std::move(grid),
          .min = 0.0,
          .max = 0.3,
          .place = true};
}

/// Speed over which dry friction changes direction: the rounding of a sliding contact.
[[nodiscard]] inline LawParameter reversal_speed() {
  return shape("v_s", "m/s", "speed over which the direction changes", {1e-4, 2e-5, 5e-4}, 5e-6, 5e-3);
}

/// sqrt(a^2 + s^2): |a| rounded over the width s, and never less than |a|, so that a state which decays by it stays
/// bounded.
[[nodiscard]] inline LawScalar magnitude(const LawScalar& a, double s) { return sqrt(a * a + s * s); }

/// Width of |v| at standstill in laws that remember a deflection: creep below it relaxes them. [m/s]
inline constexpr double kStandstill_m_s = 1e-9;

/// Pressure below which a turbulent flow is laminar, in the sizes of `eha`. [Pa]
inline constexpr double kLaminar_Pa = 1e3;

/// sgn(a) max(|a| - end, 0), its corners rounded over the width s: odd, and zero at zero.
[[nodiscard]] inline LawScalar beyond(const LawScalar& a, const LawScalar& end, double s) {
  return smooth_positive(a - end, s) - smooth_positive(-a - end, s);
}

[[nodiscard]] inline LawScalar sine(const LawScalar& a) { return a.chain(std::sin(a.value), std::cos(a.value)); }

/// exp(-a^2)
[[nodiscard]] inline LawScalar bell(const LawScalar& a) { return exp(-(a * a)); }

/// An absolute pressure that stays above a floor, rounded over a width: below that the oil has cavitated. [Pa]
[[nodiscard]] inline LawScalar above_vacuum(const LawScalar& pressure, const Roundings& floor_and_width) {
  return floor_and_width[0] + smooth_positive(pressure - floor_and_width[0], floor_and_width[1]);
}
inline constexpr double kVacuum_Pa = 1e3, kVacuumWidth_Pa = 500.0;

/// A tank's level that stays above a floor, rounded over a width. [V]
[[nodiscard]] inline LawScalar wetted(const LawScalar& level, const Roundings& floor_and_width) {
  return floor_and_width[0] + smooth_positive(level, floor_and_width[1]);
}

}  // namespace sealwatch::laws
