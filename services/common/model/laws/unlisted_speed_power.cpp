#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// F = k_v sgn(v) |v / 1 mm/s|^a_v
static LawOutput evaluate_unlisted_speed_power(const LawInput& in) {
  return {.contribution = in.parameter[0] * signed_power(in.signal[0], in.parameter[1], in.rounding[0]), .rate = {}};
}

Law unlisted_speed_power() {
  return {.id = kUnlisted,
          .form = "speed_power",
          .kind = SiteKind::piston_force,
          .equation = "k_v sgn(v) abs(v / 1 mm/s)^a_v",
          .meaning = "force against the motion that follows a power of speed",
          .energy = "k_v >= 0: it always opposes the motion",
          .source = kClosedFormSource,
          .closed_form = true,
          .parameters = {strength("k_v", "N", "force at 1 mm/s", {.usual = 1e3, .significant = 400.0, .max = 1e5}),
                         exponent("a_v", {1.5, 0.5, 3.0}, 0.2, 5.0)},
          .evaluate = &evaluate_unlisted_speed_power,
          .roundings = {{"m/s", kCorner * kSpeed_m_s, "1 mm/s"}}};
}

}  // namespace sealwatch::laws
