#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// F = F_t tanh(v / v_t) exp(-((x - x_t) / w_t)^2)
static LawOutput evaluate_unlisted_tight_spot(const LawInput& in) {
  const auto& [F_t, x_t, w_t, v_t] = in.parameter;
  return {.contribution = F_t * tanh(in.signal[0] / v_t) * bell((in.signal[1] - x_t) / w_t), .rate = {}};
}

Law unlisted_tight_spot() {
  return {
      .id = kUnlisted,
      .form = "tight_spot",
      .kind = SiteKind::piston_force,
      .equation = "F_t tanh(v / v_t) exp(-((x - x_t) / w_t)^2)",
      .meaning = "dry friction around one position: a tight spot, a bent rod",
      .energy = "F_t >= 0: it always opposes the motion",
      .source = kClosedFormSource,
      .closed_form = true,
      .parameters = {strength("F_t", "N", "friction force at the position",
                              {.usual = 2e3, .significant = 600.0, .max = 1e5}),
                     place("x_t", {0.052, 0.047, 0.057}), shape("w_t", "m", "half width", {4e-3, 1.5e-3}, 5e-4, 0.1),
                     shape("v_t", "m/s", "speed over which the direction changes", {1e-4}, 5e-6, 5e-3)},
      .evaluate = &evaluate_unlisted_tight_spot};
}

}  // namespace sealwatch::laws
