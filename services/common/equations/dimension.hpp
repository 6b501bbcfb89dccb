// Units as products of powers of the seven SI base units, for checking equations.
//
//   find_dimension("V^0.5/s")        {scale 1, m^1 kg^0.5 s^-2.5 A^-0.5}
//   find_dimension("m3/(s Pa)"), find_dimension("N s/m"), find_dimension("bar") {scale 1e5}
//
// Factors stand side by side (blank, * or .), powers behind them (m3, V^0.5), `/` divides by the next factor or bracket.
// Angles are plain numbers. Prefixes of SI are known before units of SI.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "sealwatch/core/result.hpp"

namespace sealwatch::equations {

struct Dimension {
  std::array<double, 7> power{};  ///< m, kg, s, A, K, mol, cd
  double scale = 1.0;             ///< to the coherent SI unit
  bool operator==(const Dimension& other) const { return power == other.power; }
};

[[nodiscard]] Result<Dimension> find_dimension(std::string_view unit);
[[nodiscard]] Dimension multiply(const Dimension& a, const Dimension& b, double power_of_b = 1.0);
[[nodiscard]] Dimension raised(const Dimension& a, double power);
/// "kg m/s2"; "1" of a plain number.
[[nodiscard]] std::string words_of(const Dimension& dimension);

}  // namespace sealwatch::equations
