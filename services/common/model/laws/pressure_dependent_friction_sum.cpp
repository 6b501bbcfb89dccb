#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// F = k |p_A + p_B| tanh(v / v_s), |.| rounded over 1e4 Pa: nothing where a plant knows of no pressure
static LawOutput evaluate_pressure_dependent_friction_sum(const LawInput& in) {
  const auto& [v, x, p_A, p_B] = in.signal;
  const auto& k = in.parameter[0];
  const auto& v_s = in.parameter[1];
  return {.contribution = k * smooth_abs(p_A + p_B, in.rounding[0]) * tanh(v / v_s), .rate = {}};
}

Law pressure_dependent_friction_sum() {
  return {.id = "pressure_dependent_friction",
          .form = "sum",
          .kind = SiteKind::piston_force,
          .equation = "k (p_A + p_B) tanh(v / v_s)",
          .meaning = "friction of rod and piston seals that the pressures of both chambers press against their faces",
          .energy = "k >= 0: it always opposes the motion",
          .source = "Bonchis, Corke, Rye, IEEE Int. Conf. Robotics and Automation (1999): pressure-based friction",
          .parameters = {strength("k", "m2", "seal face times friction coefficient",
                                  {.usual = 1e-4, .significant = 5e-5, .max = 1e-2}),
                         reversal_speed()},
          .evaluate = &evaluate_pressure_dependent_friction_sum,
          .roundings = {{"Pa", 1e4}}};
}

}  // namespace sealwatch::laws
