#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// F = F_x sgn(x) |x / 50 mm|^a_x
static LawOutput evaluate_spring_load_power(const LawInput& in) {
  return {.contribution = in.parameter[0] * signed_power(in.signal[1], in.parameter[1], in.rounding[0]), .rate = {}};
}

Law spring_load_power() {
  return {.id = "spring_load",
          .form = "power",
          .kind = SiteKind::piston_force,
          .equation = "F_x sgn(x) abs(x / 50 mm)^a_x",
          .meaning = "a spring that stiffens or softens with its deflection: exponent 3 is Duffing's cubic spring",
          .energy = "none: a function of position alone takes and returns the same work",
          .source = kClosedFormSource,
          .closed_form = true,
          .parameters = {strength("F_x", "N", "force at 50 mm",
                                  {.usual = 2.5e3, .significant = 1.5e3, .max = 1e6, .either_sign = true}),
                         exponent("a_x", {3.0, 2.0}, 1.2, 7.0)},
          .evaluate = &evaluate_spring_load_power,
          .roundings = {{"m", kCorner * kPosition_m, "50 mm"}}};
}

}  // namespace sealwatch::laws
