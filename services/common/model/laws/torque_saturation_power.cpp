#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// T = T_i sgn(i) |i / 1 A|^n: torque that the iron does not give any more.
static LawOutput evaluate_torque_saturation_power(const LawInput& in) {
  return {.contribution = in.parameter[0] * signed_power(in.signal[2], in.parameter[1], in.rounding[0]), .rate = {}};
}

Law torque_saturation_power() {
  return {.id = "torque_saturation",
          .form = "power",
          .kind = SiteKind::shaft_torque,
          .equation = "T_i sgn(i) abs(i / 1 A)^n",
          .meaning = "the iron saturates by some power of the current",
          .energy = "T_i >= 0, below T_M i: the torque keeps the current's sign",
          .source = kClosedFormSource,
          .closed_form = true,
          .parameters = {strength("T_i", "N m", "torque lost at 1 A", {.usual = 4e-4, .significant = 8e-5, .max = 0.1}),
                         exponent("n", {2.0, 4.0}, 1.2, 8.0)},
          .evaluate = &evaluate_torque_saturation_power,
          .roundings = {{"A", kCorner * kCurrent_A, "1 A"}}};
}

}  // namespace sealwatch::laws
