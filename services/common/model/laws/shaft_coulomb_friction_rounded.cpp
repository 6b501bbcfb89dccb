#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// T = T_c omega / (|omega|^m + omega_s^m)^(1/m)
static LawOutput evaluate_shaft_coulomb_friction_rounded(const LawInput& in) {
  return {.contribution = in.parameter[0] * rounded_sign(in.signal[0], in.parameter[1], in.parameter[2]), .rate = {}};
}

Law shaft_coulomb_friction_rounded() {
  return {.id = "shaft_coulomb_friction",
          .form = "rounded",
          .kind = SiteKind::shaft_torque,
          .equation = "T_c omega / (abs(omega)^m + omega_s^m)^(1/m)",
          .meaning = "dry friction of bearings and shaft seal that changes direction more gently or more sharply",
          .energy = "T_c >= 0: it always opposes the rotation",
          .source = kClosedFormSource,
          .closed_form = true,
          .parameters = {strength("T_c", "N m", "friction torque", {.usual = 0.02, .significant = 5e-3, .max = 5.0}),
                         shape("omega_s", "rad/s", "speed over which the direction changes", {2.0}, 0.05, 50.0),
                         sharpness()},
          .evaluate = &evaluate_shaft_coulomb_friction_rounded};
}

}  // namespace sealwatch::laws
