#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// q = k_0 (p_1 - p_2) / (1 + |omega / omega_k|^m): m = 1 is the law of speed_dependent_pump_slip_falling.cpp.
static LawOutput evaluate_speed_dependent_pump_slip_fading(const LawInput& in) {
  const LawScalar speed = even_power(in.signal[1] / in.parameter[1], in.parameter[2], kCorner);
  return {.contribution = in.parameter[0] * in.signal[0] / (1.0 + speed), .rate = {}};
}

Law speed_dependent_pump_slip_fading() {
  return {.id = "speed_dependent_pump_slip",
          .form = "fading",
          .kind = SiteKind::pump_slip,
          .equation = "k_0 (p_1 - p_2) / (1 + abs(omega / omega_k)^m)",
          .meaning = "leakage of the pump that is larger when it turns slowly, by some power of its speed",
          .energy = "k_0 >= 0: oil leaks from the higher pressure to the lower",
          .source = kClosedFormSource,
          .closed_form = true,
          .parameters = {strength("k_0", "m3/(s Pa)", "flow per pressure at rest",
                                  {.usual = 2e-14, .significant = 8e-15, .max = 1e-10}),
                         shape("omega_k", "rad/s", "speed at which it has halved", {30.0, 100.0}, 1.0, 1000.0),
                         exponent("m", {2.0}, 0.5, 6.0)},
          .evaluate = &evaluate_speed_dependent_pump_slip_fading};
}

}  // namespace sealwatch::laws
