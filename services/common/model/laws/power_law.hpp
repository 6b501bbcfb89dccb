// Closed forms for what no other law describes: products of powers of signals over reference sizes, so that
// every strength has the unit of what it scales and every exponent is a plain number. A form whose signals are those of
// a listed id bears that id (a leak of the pump by any power of its speed is a speed-dependent slip); the others share
// the id `unlisted`. Their grids start away from the exponents of the other laws.
//
//   signed power     sgn(s) |s / S|^a  ~  (s / S) ((s / S)^2 + c^2)^((a - 1) / 2)
//   even power       |s / S|^b         ~          ((s / S)^2 + c^2)^(b / 2)
//
// S: reference size of the signal s; w = c S: width over which the corner at 0 is rounded, so that both are finite and
// differentiable there for any exponent. Both go with the plant's sizes: rounded over 0.2 MPa, a tank's leak would be
// laminar at any exponent, and at 500 times S a cubic drag of usual strength 250 000 times as large as a linear one.
#pragma once

#include <string_view>

#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

inline constexpr std::string_view kUnlisted = "unlisted";
inline constexpr std::string_view kClosedFormSource =
    "closed form, dimensionally consistent, for what no other law describes";

// Reference sizes, S, of `eha`.
inline constexpr double kSpeed_m_s = 1e-3;
inline constexpr double kPosition_m = 0.05;
inline constexpr double kPressure_Pa = 1e7;
inline constexpr double kShaftSpeed_rad_s = 100.0;
inline constexpr double kFlow_m3_s = 1e-5;
inline constexpr double kCommand_V = 10.0;
inline constexpr double kCurrent_A = 1.0;

/// c: share of the reference size over which corners are rounded.
inline constexpr double kCorner = 0.02;
/// Over which a relief valve or a lip opens, in the sizes of `eha`: it may hold the pressure there for long. [Pa]
inline constexpr double kOpening_Pa = 1e4;

/// `width`: w, by which S is known.
[[nodiscard]] inline LawScalar even_power(const LawScalar& signal, const LawScalar& exponent, double width) {
  const LawScalar ratio = signal * (kCorner / width);
  return exp(0.5 * exponent * log(ratio * ratio + kCorner * kCorner));
}

[[nodiscard]] inline LawScalar signed_power(const LawScalar& signal, const LawScalar& exponent, double width) {
  return signal * (kCorner / width) * even_power(signal, exponent - 1.0, width);
}

/// Dry friction's change of direction with any sharpness m: v / (|v|^m + w^m)^(1/m), about v / w at rest, 1 far away. m
/// = 2 is the algebraic root; a smaller m has the long tail of an arctangent, a larger one the corner of a clamp.
[[nodiscard]] inline LawScalar rounded_sign(const LawScalar& speed, const LawScalar& width,
                                            const LawScalar& sharpness) {
  const LawScalar ratio = speed / width;
  const LawScalar power = exp(0.5 * sharpness * log(ratio * ratio + kCorner * kCorner));
  return ratio * exp(-log(1.0 + power) / sharpness);
}

/// Sharpness of a change of direction, m.
[[nodiscard]] inline LawParameter sharpness() {
  return shape("m", "1", "sharpness of the change of direction", {2.0, 1.0, 5.0}, 0.5, 10.0);
}

/// A free exponent, searched on a grid.
[[nodiscard]] inline LawParameter exponent(std::string_view name, std::vector<double> grid, double min, double max) {
  return shape(name, "1", "exponent", std::move(grid), min, max);
}

}  // namespace sealwatch::laws
