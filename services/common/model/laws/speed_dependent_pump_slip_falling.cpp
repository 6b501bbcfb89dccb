#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// q = k_0 dp / (1 + |omega| / omega_k), |omega| rounded over 1 rad/s
static LawOutput evaluate_speed_dependent_pump_slip_falling(const LawInput& in) {
  const auto& omega_k = in.parameter[1];
  return {.contribution = in.parameter[0] * in.signal[0] / (1.0 + smooth_abs(in.signal[1], in.rounding[0]) / omega_k),
          .rate = {}};
}

Law speed_dependent_pump_slip_falling() {
  return {.id = "speed_dependent_pump_slip",
          .form = "falling",
          .kind = SiteKind::pump_slip,
          .equation = "k_0 (p_1 - p_2) / (1 + abs(omega) / omega_k)",
          .meaning = "leakage of the pump that is larger when it turns slowly, before its oil films seal",
          .energy = "k_0 >= 0: oil leaks from the higher pressure to the lower",
          .source = "Jeong, Journal of Mechanical Science and Technology 21 (2007) 83: leakage falls with speed",
          .parameters = {strength("k_0", "m3/(s Pa)", "flow per pressure at rest",
                                  {.usual = 2e-14, .significant = 8e-15, .max = 1e-10}),
                         shape("omega_k", "rad/s", "speed at which it has halved", {30.0, 10.0, 100.0}, 1.0, 1000.0)},
          .evaluate = &evaluate_speed_dependent_pump_slip_falling,
          .roundings = {{"rad/s", 1.0}}};
}

}  // namespace sealwatch::laws
