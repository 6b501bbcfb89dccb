#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// F = F_h zeta, d zeta/dt = (v - (|v| zeta + v |zeta|) / 2) / x_y: Bouc and Wen with exponent 1 and beta = gamma, so
// that unloading is straight; zeta from -1 to 1, |zeta| rounded over 1e-3.
static LawOutput evaluate_hysteretic_load(const LawInput& in) {
  const auto& v = in.signal[0];
  const auto& zeta = in.hidden;
  const auto& F_h = in.parameter[0];
  const auto& x_y = in.parameter[1];
  const LawScalar yielding = magnitude(v, in.rounding[0]) * zeta + v * magnitude(zeta, 1e-3);
  return {.contribution = F_h * zeta, .rate = (v - 0.5 * yielding) / x_y};
}

Law hysteretic_load() {
  return {
      .id = "hysteretic_load",
      .form = "",
      .kind = SiteKind::piston_force,
      .equation = "F_h zeta, x_y dzeta/dt = v - (abs(v) zeta + v abs(zeta)) / 2",
      .meaning = "load that depends on how the position was reached: packing or a gate that yields over millimetres",
      .energy = "F_h >= 0: a closed path always costs work",
      .source = "Wen, Journal of the Engineering Mechanics Division ASCE 102 (1976) 249",
      .parameters = {strength("F_h", "N", "load once it has yielded", {.usual = 1e3, .significant = 600.0, .max = 1e5}),
                     shape("x_y", "m", "distance over which it yields", {2e-3, 5e-4, 6e-3}, 1e-4, 5e-2)},
      .hidden =
          HiddenState{.name = "memory", .unit = "1", .scale = 1.0, .free_initial = true, .least = -1.0, .most = 1.0},
      .evaluate = &evaluate_hysteretic_load,
      .roundings = {{"m/s", kStandstill_m_s}},
      .limit = "coulomb_friction"};
}

}  // namespace sealwatch::laws
