#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// F = k_d |p_A - p_B| tanh(v / v_s), |.| rounded over 1e4 Pa
static LawOutput evaluate_pressure_dependent_friction_difference(const LawInput& in) {
  const auto& [v, x, p_A, p_B] = in.signal;
  const auto& k_d = in.parameter[0];
  const auto& v_s = in.parameter[1];
  return {.contribution = k_d * smooth_abs(p_A - p_B, in.rounding[0]) * tanh(v / v_s), .rate = {}};
}

Law pressure_dependent_friction_difference() {
  return {.id = "pressure_dependent_friction",
          .form = "difference",
          .kind = SiteKind::piston_force,
          .equation = "k_d abs(p_A - p_B) tanh(v / v_s)",
          .meaning = "friction of the piston seal, which the pressure across it presses against the bore",
          .energy = "k_d >= 0: it always opposes the motion",
          .source = "Bonchis, Corke, Rye, IEEE Int. Conf. Robotics and Automation (1999): pressure-based friction",
          .parameters = {strength("k_d", "m2", "seal face times friction coefficient",
                                  {.usual = 1e-4, .significant = 6e-5, .max = 1e-2}),
                         reversal_speed()},
          .evaluate = &evaluate_pressure_dependent_friction_difference,
          .roundings = {{"Pa", 1e4}}};
}

}  // namespace sealwatch::laws
