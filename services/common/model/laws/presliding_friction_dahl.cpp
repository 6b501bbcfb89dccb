#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// F = F_c zeta, d zeta/dt = (v - |v| zeta) / delta: zeta is the bristles' deflection as a share of the largest, delta.
static LawOutput evaluate_presliding_friction_dahl(const LawInput& in) {
  const auto& v = in.signal[0];
  const auto& zeta = in.hidden;
  const auto& F_c = in.parameter[0];
  const auto& delta = in.parameter[1];
  return {.contribution = F_c * zeta, .rate = (v - magnitude(v, in.rounding[0]) * zeta) / delta};
}

Law presliding_friction_dahl() {
  return {
      .id = "presliding_friction",
      .form = "dahl",
      .kind = SiteKind::piston_force,
      .equation = "F_c zeta, delta dzeta/dt = v - abs(v) zeta",
      .meaning = "dry friction whose contacts bend like bristles before they slide",
      .energy = "F_c >= 0: a closed path returns no more than the bristles stored",
      .source = "Dahl, Aerospace Corporation TOR-0158(3107-18)-1 (1968)",
      .parameters = {strength("F_c", "N", "friction force in sliding",
                              {.usual = 1e3, .significant = 600.0, .max = 1e5}),
                     shape("delta", "m", "deflection at which the contacts slide", {5e-5, 5e-6, 2e-4}, 1e-6, 5e-4)},
      .hidden =
          HiddenState{.name = "bristle", .unit = "1", .scale = 1.0, .free_initial = true, .least = -1.0, .most = 1.0},
      .evaluate = &evaluate_presliding_friction_dahl,
      .roundings = {{"m/s", kStandstill_m_s}},
      .limit = "coulomb_friction"};
}

}  // namespace sealwatch::laws
