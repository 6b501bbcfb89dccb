#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// F = (F_c + F_x exp(-(v / v_st)^2)) tanh(v / v_s)
static LawOutput evaluate_stribeck_friction(const LawInput& in) {
  const auto& v = in.signal[0];
  const auto& [F_c, F_x, v_st, v_s] = in.parameter;
  return {.contribution = (F_c + F_x * bell(v / v_st)) * tanh(v / v_s), .rate = {}};
}

Law stribeck_friction() {
  return {
      .id = "stribeck_friction",
      .form = "",
      .kind = SiteKind::piston_force,
      .equation = "(F_c + F_x exp(-(v / v_st)^2)) tanh(v / v_s)",
      .meaning = "dry friction that is larger near standstill, where the oil film has not formed: stick-slip",
      .energy = "F_c >= 0, F_x >= 0: it always opposes the motion",
      .source = "Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083",
      .parameters = {strength("F_c", "N", "friction force in motion", {.usual = 1e3, .significant = 600.0, .max = 1e5}),
                     strength("F_x", "N", "further force for breakaway",
                              {.usual = 1e3, .significant = 600.0, .max = 1e5}),
                     shape("v_st", "m/s", "speed at which the film forms", {5e-4, 1e-4, 2e-3}, 2e-5, 5e-2),
                     reversal_speed()},
      .evaluate = &evaluate_stribeck_friction,
      .limit = "coulomb_friction"};
}

}  // namespace sealwatch::laws
