#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// F = c_p v |(p_A - p_B) / 10 MPa|^b_d
static LawOutput evaluate_pressure_dependent_friction_drag(const LawInput& in) {
  const auto& [v, x, p_A, p_B] = in.signal;
  return {.contribution = in.parameter[0] * v * even_power(p_A - p_B, in.parameter[1], in.rounding[0]), .rate = {}};
}

Law pressure_dependent_friction_drag() {
  return {
      .id = "pressure_dependent_friction",
      .form = "drag",
      .kind = SiteKind::piston_force,
      .equation = "c_p v abs((p_A - p_B) / 10 MPa)^b_d",
      .meaning = "viscous friction that changes with the pressure across the piston",
      .energy = "c_p >= 0: it always opposes the motion",
      .source = kClosedFormSource,
      .closed_form = true,
      .parameters = {strength("c_p", "N s/m", "friction at 10 MPa", {.usual = 1e6, .significant = 4.5e5, .max = 1e8}),
                     exponent("b_d", {1.0, 2.0, -1.0}, -2.0, 4.0)},
      .evaluate = &evaluate_pressure_dependent_friction_drag,
      .roundings = {{"Pa", kCorner * kPressure_Pa, "10 MPa"}}};
}

}  // namespace sealwatch::laws
