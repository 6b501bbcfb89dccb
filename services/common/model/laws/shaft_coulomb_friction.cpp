#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// T = T_c tanh(omega / omega_s)
static LawOutput evaluate_shaft_coulomb_friction(const LawInput& in) {
  return {.contribution = in.parameter[0] * tanh(in.signal[0] / in.parameter[1]), .rate = {}};
}

Law shaft_coulomb_friction() {
  return {
      .id = "shaft_coulomb_friction",
      .form = "",
      .kind = SiteKind::shaft_torque,
      .equation = "T_c tanh(omega / omega_s)",
      .meaning = "dry friction of bearings and shaft seal: a torque of constant size against the rotation",
      .energy = "T_c >= 0: it always opposes the rotation",
      .source = "Olsson, Astrom, Canudas de Wit, Gafvert, Lischinsky, European Journal of Control 4 (1998) 176",
      .parameters = {strength("T_c", "N m", "friction torque", {.usual = 0.02, .significant = 5e-3, .max = 5.0}),
                     shape("omega_s", "rad/s", "speed over which the direction changes", {2.0, 0.5, 10.0}, 0.05, 50.0)},
      .evaluate = &evaluate_shaft_coulomb_friction};
}

}  // namespace sealwatch::laws
