#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// T = T_w sgn(omega) |omega / 100 rad/s|^a_w
static LawOutput evaluate_unlisted_torque_power(const LawInput& in) {
  return {.contribution = in.parameter[0] * signed_power(in.signal[0], in.parameter[1], in.rounding[0]), .rate = {}};
}

Law unlisted_torque_power() {
  return {
      .id = kUnlisted,
      .form = "torque_power",
      .kind = SiteKind::shaft_torque,
      .equation = "T_w sgn(omega) abs(omega / 100 rad/s)^a_w",
      .meaning = "torque against the rotation that follows a power of speed: churning oil, a fan",
      .energy = "T_w >= 0: it always opposes the rotation",
      .source = kClosedFormSource,
      .closed_form = true,
      .parameters = {strength("T_w", "N m", "torque at 100 rad/s", {.usual = 0.01, .significant = 2e-3, .max = 5.0}),
                     exponent("a_w", {2.0, 0.5, 3.0}, 0.2, 5.0)},
      .evaluate = &evaluate_unlisted_torque_power,
      .roundings = {{"rad/s", kCorner * kShaftSpeed_rad_s, "100 rad/s"}}};
}

}  // namespace sealwatch::laws
