#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// F = F_b exp(-|(x - x_b) / w_b|^m): m = 2 is the bump of position_dependent_load_bump.cpp, a larger m a plateau.
static LawOutput evaluate_position_dependent_load_bell(const LawInput& in) {
  const LawScalar away = (in.signal[1] - in.parameter[1]) / in.parameter[2];
  return {.contribution = in.parameter[0] * exp(-even_power(away, in.parameter[3], kCorner)), .rate = {}};
}

Law position_dependent_load_bell() {
  return {.id = "position_dependent_load",
          .form = "bell",
          .kind = SiteKind::piston_force,
          .equation = "F_b exp(-abs((x - x_b) / w_b)^m)",
          .meaning = "load that rises or falls around one position, more gently or more sharply",
          .energy = "none: a function of position alone takes and returns the same work",
          .source = kClosedFormSource,
          .closed_form = true,
          .parameters = {strength("F_b", "N", "load at the position",
                                  {.usual = 2e3, .significant = 600.0, .max = 1e5, .either_sign = true}),
                         place("x_b", {0.052}), shape("w_b", "m", "half width", {4e-3}, 5e-4, 0.1),
                         shape("m", "1", "sharpness of its flanks", {2.0, 3.0}, 1.0, 10.0)},
          .evaluate = &evaluate_position_dependent_load_bell};
}

}  // namespace sealwatch::laws
