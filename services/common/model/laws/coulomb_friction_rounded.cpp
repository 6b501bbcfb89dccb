#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// F = F_c v / (|v|^m + v_s^m)^(1/m)
static LawOutput evaluate_coulomb_friction_rounded(const LawInput& in) {
  return {.contribution = in.parameter[0] * rounded_sign(in.signal[0], in.parameter[1], in.parameter[2]), .rate = {}};
}

Law coulomb_friction_rounded() {
  return {
      .id = "coulomb_friction",
      .form = "rounded",
      .kind = SiteKind::piston_force,
      .equation = "F_c v / (abs(v)^m + v_s^m)^(1/m)",
      .meaning = "dry friction that changes direction more gently or more sharply",
      .energy = "F_c >= 0: it always opposes the motion",
      .source = kClosedFormSource,
      .closed_form = true,
      .parameters = {strength("F_c", "N", "friction force", {.usual = 1e3, .significant = 600.0, .max = 1e5}),
                     shape("v_s", "m/s", "speed over which the direction changes", {1e-4}, 5e-6, 5e-3), sharpness()},
      .evaluate = &evaluate_coulomb_friction_rounded};
}

}  // namespace sealwatch::laws
