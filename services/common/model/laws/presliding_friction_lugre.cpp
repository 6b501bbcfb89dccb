#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// F = F_c zeta + sigma_1 delta d zeta/dt, d zeta/dt = (v - |v| zeta) / delta: Dahl's bristles with their own damping.
static LawOutput evaluate_presliding_friction_lugre(const LawInput& in) {
  const auto& v = in.signal[0];
  const auto& zeta = in.hidden;
  const auto& F_c = in.parameter[0];
  const auto& delta = in.parameter[1];
  const auto& sigma_1 = in.parameter[2];
  const LawScalar deflection_rate = v - magnitude(v, in.rounding[0]) * zeta;
  return {.contribution = F_c * zeta + sigma_1 * deflection_rate, .rate = deflection_rate / delta};
}

Law presliding_friction_lugre() {
  return {
      .id = "presliding_friction",
      .form = "lugre",
      .kind = SiteKind::piston_force,
      .equation = "F_c zeta + sigma_1 delta dzeta/dt, delta dzeta/dt = v - abs(v) zeta",
      .meaning = "dry friction whose contacts bend like damped bristles before they slide",
      .energy = "F_c >= 0, sigma_1 >= 0: a closed path returns no more than the bristles stored",
      .source = "Canudas de Wit, Olsson, Astrom, Lischinsky, IEEE Trans. Automatic Control 40 (1995) 419",
      .parameters = {strength("F_c", "N", "friction force in sliding",
                              {.usual = 1e3, .significant = 600.0, .max = 1e5}),
                     shape("delta", "m", "deflection at which the contacts slide", {5e-5, 5e-6, 2e-4}, 1e-6, 5e-4),
                     strength("sigma_1", "N s/m", "damping of the bristles",
                              {.usual = 1e5, .significant = 4e5, .max = 1e7})},
      .hidden =
          HiddenState{.name = "bristle", .unit = "1", .scale = 1.0, .free_initial = true, .least = -1.0, .most = 1.0},
      .evaluate = &evaluate_presliding_friction_lugre,
      .roundings = {{"m/s", kStandstill_m_s}},
      .limit = "coulomb_friction"};
}

}  // namespace sealwatch::laws
