#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// q = q_s sgn(D) |D / 10 MPa|^a_s, D = p_A - p_B
static LawOutput evaluate_unlisted_leakage_power(const LawInput& in) {
  return {.contribution = in.parameter[0] * signed_power(in.signal[0], in.parameter[1], in.rounding[0]), .rate = {}};
}

Law unlisted_leakage_power() {
  return {.id = kUnlisted,
          .form = "leakage_power",
          .kind = SiteKind::seal_leakage,
          .equation = "q_s sgn(p_A - p_B) abs((p_A - p_B) / 10 MPa)^a_s",
          .meaning = "leakage past the piston that follows a power of the pressure difference",
          .energy = "q_s >= 0: oil leaks from the higher pressure to the lower",
          .source = kClosedFormSource,
          .closed_form = true,
          .parameters = {strength("q_s", "m3/s", "flow at 10 MPa", {.usual = 3e-7, .significant = 8e-8, .max = 1e-4}),
                         exponent("a_s", {1.5, 2.0, 3.0}, 0.2, 5.0)},
          .evaluate = &evaluate_unlisted_leakage_power,
          .roundings = {{"Pa", kCorner * kPressure_Pa, "10 MPa"}}};
}

}  // namespace sealwatch::laws
