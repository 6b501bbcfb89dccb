#include <cmath>

#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// F = F_c tanh(v / v_s)
static LawOutput evaluate(const LawInput& in) {
  const auto& [F_c, v_s, unused_2, unused_3] = in.parameter;
  return {.contribution = F_c * tanh(in.signal[0] / v_s), .rate = {}};
}

Law coulomb_friction() {
  return {.id = "coulomb_friction",
          .form = "",
          .kind = SiteKind::piston_force,
          .equation = "F_c tanh(v / v_s)",
          .meaning = "dry friction of seals and guides: a force of constant size against the motion",
          .energy = "F_c >= 0: it always opposes the motion",
          .source = "Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083",
          .parameters = {{.name = "F_c",
                          .unit = "N",
                          .meaning = "friction force",
                          .start = {1e3},
                          .min = 0.0,
                          .max = 1e5,
                          .strength = true,
                          .significant = 600.0},
                         {.name = "v_s",
                          .unit = "m/s",
                          .meaning = "speed over which the direction changes",
                          .start = {1e-4, 2e-5, 5e-4},
                          .min = 5e-6,
                          .max = 5e-3}},
          .evaluate = &evaluate};
}

}  // namespace sealwatch::laws
