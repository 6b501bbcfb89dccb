#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// F = F_c tanh(v / v_s)
static LawOutput evaluate_coulomb_friction(const LawInput& in) {
  const auto& F_c = in.parameter[0];
  const auto& v_s = in.parameter[1];
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
          .parameters = {strength("F_c", "N", "friction force", {.usual = 1e3, .significant = 600.0, .max = 1e5}),
                         reversal_speed()},
          .evaluate = &evaluate_coulomb_friction};
}

}  // namespace sealwatch::laws
