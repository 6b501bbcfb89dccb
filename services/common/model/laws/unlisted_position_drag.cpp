#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// F = c_x v |x / 50 mm|^b_x
static LawOutput evaluate_unlisted_position_drag(const LawInput& in) {
  return {.contribution = in.parameter[0] * in.signal[0] * even_power(in.signal[1], in.parameter[1], in.rounding[0]),
          .rate = {}};
}

Law unlisted_position_drag() {
  return {
      .id = kUnlisted,
      .form = "position_drag",
      .kind = SiteKind::piston_force,
      .equation = "c_x v abs(x / 50 mm)^b_x",
      .meaning = "viscous friction that changes along the stroke",
      .energy = "c_x >= 0: it always opposes the motion",
      .source = kClosedFormSource,
      .closed_form = true,
      .parameters = {strength("c_x", "N s/m", "friction at 50 mm", {.usual = 1e6, .significant = 4.5e5, .max = 1e8}),
                     exponent("b_x", {4.0, -2.0}, -3.0, 8.0)},
      .evaluate = &evaluate_unlisted_position_drag,
      .roundings = {{"m", kCorner * kPosition_m, "50 mm"}}};
}

}  // namespace sealwatch::laws
