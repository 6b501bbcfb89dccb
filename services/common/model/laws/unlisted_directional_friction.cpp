#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// F = F_plus max(tanh(v / v_d), 0) - F_minus max(-tanh(v / v_d), 0), corners rounded over 0.02
static LawOutput evaluate_unlisted_directional_friction(const LawInput& in) {
  const LawScalar direction = tanh(in.signal[0] / in.parameter[2]);
  const LawScalar size = magnitude(direction, kCorner);
  return {.contribution = 0.5 * direction *
                          (in.parameter[0] * (1.0 + direction / size) + in.parameter[1] * (1.0 - direction / size)),
          .rate = {}};
}

Law unlisted_directional_friction() {
  return {.id = kUnlisted,
          .form = "directional_friction",
          .kind = SiteKind::piston_force,
          .equation = "F_plus max(tanh(v / v_d), 0) - F_minus max(-tanh(v / v_d), 0)",
          .meaning = "friction that acts in one direction of motion, or differs between the two",
          .energy = "F_plus >= 0, F_minus >= 0: it always opposes the motion",
          .source = kClosedFormSource,
          .closed_form = true,
          .parameters = {strength("F_plus", "N", "friction moving towards +x",
                                  {.usual = 1e3, .significant = 600.0, .max = 1e5}),
                         strength("F_minus", "N", "friction moving towards -x",
                                  {.usual = 1e3, .significant = 600.0, .max = 1e5}),
                         shape("v_d", "m/s", "speed over which it builds up", {1e-4, 2e-3}, 5e-6, 0.02)},
          .evaluate = &evaluate_unlisted_directional_friction};
}

}  // namespace sealwatch::laws
