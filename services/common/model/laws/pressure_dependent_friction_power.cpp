#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// F = F_p tanh(v / v_p) |(p_A - p_B) / 10 MPa|^b_p
static LawOutput evaluate_pressure_dependent_friction_power(const LawInput& in) {
  const auto& [v, x, p_A, p_B] = in.signal;
  const auto& v_p = in.parameter[2];
  return {.contribution = in.parameter[0] * tanh(v / v_p) * even_power(p_A - p_B, in.parameter[1], in.rounding[0]),
          .rate = {}};
}

Law pressure_dependent_friction_power() {
  return {
      .id = "pressure_dependent_friction",
      .form = "power",
      .kind = SiteKind::piston_force,
      .equation = "F_p tanh(v / v_p) abs((p_A - p_B) / 10 MPa)^b_p",
      .meaning = "dry friction that follows a power of the pressure across the piston",
      .energy = "F_p >= 0: it always opposes the motion",
      .source = kClosedFormSource,
      .closed_form = true,
      .parameters = {strength("F_p", "N", "friction force at 10 MPa", {.usual = 1e3, .significant = 600.0, .max = 1e5}),
                     exponent("b_p", {2.0, 0.5}, -1.0, 4.0),
                     shape("v_p", "m/s", "speed over which the direction changes", {1e-4}, 5e-6, 5e-3)},
      .evaluate = &evaluate_pressure_dependent_friction_power,
      .roundings = {{"Pa", kCorner * kPressure_Pa, "10 MPa"}}};
}

}  // namespace sealwatch::laws
