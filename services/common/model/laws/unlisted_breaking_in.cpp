#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// F = F_r (1 - h) tanh(v / v_r), s_r dh/dt = |v| (1 - h): h = 1 - exp(-way / s_r). |v| rounded at 1e-9 m/s.
static LawOutput evaluate_unlisted_breaking_in(const LawInput& in) {
  const auto& [F_r, s_r, v_r, none] = in.parameter;
  const LawScalar left = 1.0 - in.hidden;
  return {.contribution = F_r * left * tanh(in.signal[0] / v_r),
          .rate = magnitude(in.signal[0], in.rounding[0]) * left / s_r};
}

Law unlisted_breaking_in() {
  return {
      .id = kUnlisted,
      .form = "breaking_in",
      .kind = SiteKind::piston_force,
      .equation = "F_r (1 - h) tanh(v / v_r), s_r dh/dt = abs(v) (1 - h)",
      .meaning = "dry friction after standstill that fades with the distance moved",
      .energy = "F_r >= 0: it always opposes the motion",
      .source = kClosedFormSource,
      .closed_form = true,
      .parameters = {strength("F_r", "N", "friction force at first", {.usual = 2e3, .significant = 600.0, .max = 1e5}),
                     shape("s_r", "m", "distance over which it fades", {5e-3, 1e-3}, 1e-4, 0.1),
                     shape("v_r", "m/s", "speed over which the direction changes", {1e-4}, 5e-6, 5e-3)},
      .hidden = HiddenState{.name = "worn_off", .unit = "1", .scale = 1.0},
      .evaluate = &evaluate_unlisted_breaking_in,
      .roundings = {{"m/s", kStandstill_m_s}}};
}

}  // namespace sealwatch::laws
