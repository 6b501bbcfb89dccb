#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// q = G_v (p_A - p_B) |v / 1 mm/s|^b_v
static LawOutput evaluate_unlisted_moving_leakage(const LawInput& in) {
  return {.contribution = in.parameter[0] * in.signal[0] * even_power(in.signal[1], in.parameter[1], in.rounding[0]),
          .rate = {}};
}

Law unlisted_moving_leakage() {
  return {.id = kUnlisted,
          .form = "moving_leakage",
          .kind = SiteKind::seal_leakage,
          .equation = "G_v (p_A - p_B) abs(v / 1 mm/s)^b_v",
          .meaning = "leakage past the piston that comes with its motion: a lip that lifts as it slides",
          .energy = "G_v >= 0: oil leaks from the higher pressure to the lower",
          .source = kClosedFormSource,
          .closed_form = true,
          .parameters = {strength("G_v", "m3/(s Pa)", "flow per pressure at 1 mm/s",
                                  {.usual = 3e-14, .significant = 8e-15, .max = 1e-11}),
                         exponent("b_v", {1.0, 2.0, 0.5}, 0.1, 4.0)},
          .evaluate = &evaluate_unlisted_moving_leakage,
          .roundings = {{"m/s", kCorner * kSpeed_m_s, "1 mm/s"}}};
}

}  // namespace sealwatch::laws
