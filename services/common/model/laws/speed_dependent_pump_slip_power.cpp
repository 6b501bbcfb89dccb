#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// q = G_w (p_1 - p_2) |omega / 100 rad/s|^b_w
static LawOutput evaluate_speed_dependent_pump_slip_power(const LawInput& in) {
  return {.contribution = in.parameter[0] * in.signal[0] * even_power(in.signal[1], in.parameter[1], in.rounding[0]),
          .rate = {}};
}

Law speed_dependent_pump_slip_power() {
  return {.id = "speed_dependent_pump_slip",
          .form = "power",
          .kind = SiteKind::pump_slip,
          .equation = "G_w (p_1 - p_2) abs(omega / 100 rad/s)^b_w",
          .meaning = "leakage of the pump that follows a power of its speed",
          .energy = "G_w >= 0: oil leaks from the higher pressure to the lower",
          .source = kClosedFormSource,
          .closed_form = true,
          .parameters = {strength("G_w", "m3/(s Pa)", "flow per pressure at 100 rad/s",
                                  {.usual = 2e-14, .significant = 8e-15, .max = 1e-10}),
                         exponent("b_w", {2.0, 0.5, -0.5}, -1.0, 4.0)},
          .evaluate = &evaluate_speed_dependent_pump_slip_power,
          .roundings = {{"rad/s", kCorner * kShaftSpeed_rad_s, "100 rad/s"}}};
}

}  // namespace sealwatch::laws
