#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// As in pressure_dependent_friction_sum.cpp, with any sharpness of the change of direction.
static LawOutput evaluate_pressure_dependent_friction_sum_rounded(const LawInput& in) {
  const auto& [v, x, p_A, p_B] = in.signal;
  return {.contribution = in.parameter[0] * smooth_abs(p_A + p_B, in.rounding[0]) *
                          rounded_sign(v, in.parameter[1], in.parameter[2]),
          .rate = {}};
}

Law pressure_dependent_friction_sum_rounded() {
  return {
      .id = "pressure_dependent_friction",
      .form = "sum_rounded",
      .kind = SiteKind::piston_force,
      .equation = "k (p_A + p_B) v / (abs(v)^m + v_s^m)^(1/m)",
      .meaning =
          "friction of rod and piston seals under both chambers' pressures, which changes direction more gently or "
          "more sharply",
      .energy = "k >= 0: it always opposes the motion",
      .source = kClosedFormSource,
      .closed_form = true,
      .parameters = {strength("k", "m2", "seal face times friction coefficient",
                              {.usual = 1e-4, .significant = 5e-5, .max = 1e-2}),
                     shape("v_s", "m/s", "speed over which the direction changes", {1e-4}, 5e-6, 5e-3), sharpness()},
      .evaluate = &evaluate_pressure_dependent_friction_sum_rounded,
      .roundings = {{"Pa", 1e4}}};
}

}  // namespace sealwatch::laws
