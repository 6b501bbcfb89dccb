#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// q = q_p sgn(D) |D / 10 MPa|^a_p, D = p_1 - p_2
static LawOutput evaluate_unlisted_slip_power(const LawInput& in) {
  return {.contribution = in.parameter[0] * signed_power(in.signal[0], in.parameter[1], in.rounding[0]), .rate = {}};
}

Law unlisted_slip_power() {
  return {.id = kUnlisted,
          .form = "slip_power",
          .kind = SiteKind::pump_slip,
          .equation = "q_p sgn(p_1 - p_2) abs((p_1 - p_2) / 10 MPa)^a_p",
          .meaning = "leakage of the pump that follows a power of the pressure difference",
          .energy = "q_p >= 0: oil leaks from the higher pressure to the lower",
          .source = kClosedFormSource,
          .closed_form = true,
          .parameters = {strength("q_p", "m3/s", "flow at 10 MPa", {.usual = 2e-7, .significant = 8e-8, .max = 1e-4}),
                         exponent("a_p", {1.5, 2.0, 3.0}, 0.2, 5.0)},
          .evaluate = &evaluate_unlisted_slip_power,
          .roundings = {{"Pa", kCorner * kPressure_Pa, "10 MPa"}}};
}

}  // namespace sealwatch::laws
