#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// F = F_e exp(-|x| / x_e), |x| rounded over 1 mm
static LawOutput evaluate_unlisted_decaying_load(const LawInput& in) {
  return {.contribution = in.parameter[0] * exp(-(smooth_abs(in.signal[1], in.rounding[0]) / in.parameter[1])),
          .rate = {}};
}

Law unlisted_decaying_load() {
  return {.id = kUnlisted,
          .form = "decaying_load",
          .kind = SiteKind::piston_force,
          .equation = "F_e exp(-abs(x) / x_e)",
          .meaning = "load that dies out along the stroke, as of a gate that leaves its seat",
          .energy = "none: a function of position alone takes and returns the same work",
          .source = kClosedFormSource,
          .closed_form = true,
          .parameters = {strength("F_e", "N", "load at the end of the stroke",
                                  {.usual = 2e4, .significant = 6e3, .max = 1e6, .either_sign = true}),
                         shape("x_e", "m", "distance over which it decays", {0.02, 5e-3}, 2e-3, 0.2)},
          .evaluate = &evaluate_unlisted_decaying_load,
          .roundings = {{"m", 1e-3}}};
}

}  // namespace sealwatch::laws
