#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// T = c_w omega |(p_1 - p_2) / 10 MPa|^b_t
static LawOutput evaluate_pressure_dependent_shaft_friction_power(const LawInput& in) {
  return {.contribution = in.parameter[0] * in.signal[0] * even_power(in.signal[1], in.parameter[1], in.rounding[0]),
          .rate = {}};
}

Law pressure_dependent_shaft_friction_power() {
  return {.id = "pressure_dependent_shaft_friction",
          .form = "power",
          .kind = SiteKind::shaft_torque,
          .equation = "c_w omega abs((p_1 - p_2) / 10 MPa)^b_t",
          .meaning = "viscous torque of the pump that grows with its pressure",
          .energy = "c_w >= 0: it always opposes the rotation",
          .source = kClosedFormSource,
          .closed_form = true,
          .parameters = {strength("c_w", "N m s/rad", "torque per speed at 10 MPa",
                                  {.usual = 1e-4, .significant = 2.5e-5, .max = 0.05}),
                         exponent("b_t", {1.0, 2.0, 0.5}, 0.1, 4.0)},
          .evaluate = &evaluate_pressure_dependent_shaft_friction_power,
          .roundings = {{"Pa", kCorner * kPressure_Pa, "10 MPa"}}};
}

}  // namespace sealwatch::laws
