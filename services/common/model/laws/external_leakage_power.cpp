#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// q = q_o sgn(p - p_0) |(p - p_0) / 10 MPa|^a_o
static LawOutput evaluate_external_leakage_power(const LawInput& in) {
  return {.contribution = in.parameter[0] * signed_power(in.signal[0], in.parameter[1], in.rounding[0]), .rate = {}};
}

Law external_leakage_power() {
  return {.id = "external_leakage",
          .form = "power",
          .kind = SiteKind::outflow,
          .equation = "q_o sgn(p - p_0) abs((p - p_0) / 10 MPa)^a_o",
          .meaning = "oil that leaves the chamber, as a power of its pressure",
          .energy = "q_o >= 0: oil leaks from the higher pressure to the lower",
          .source = kClosedFormSource,
          .closed_form = true,
          .parameters = {strength("q_o", "m3/s", "flow at 10 MPa", {.usual = 3e-7, .significant = 8e-8, .max = 1e-4}),
                         exponent("a_o", {1.5, 2.0, 3.0}, 0.2, 5.0)},
          .evaluate = &evaluate_external_leakage_power,
          .roundings = {{"Pa", kCorner * kPressure_Pa, "10 MPa"}}};
}

}  // namespace sealwatch::laws
