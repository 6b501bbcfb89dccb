#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// F = k_q (x - x_q)^2
static LawOutput evaluate_position_dependent_load_quadratic(const LawInput& in) {
  const auto& k_q = in.parameter[0];
  const LawScalar from_centre = in.signal[1] - in.parameter[1];
  return {.contribution = k_q * from_centre * from_centre, .rate = {}};
}

Law position_dependent_load_quadratic() {
  return {.id = "position_dependent_load",
          .form = "quadratic",
          .kind = SiteKind::piston_force,
          .equation = "k_q (x - x_q)^2",
          .meaning = "load that grows on both sides of a position",
          .energy = "none: a function of position alone takes and returns the same work",
          .source = "potential force; second term of its series",
          .parameters = {strength("k_q", "N/m2", "curvature",
                                  {.usual = 5e6, .significant = 2.3e6, .max = 1e9, .either_sign = true}),
                         shape("x_q", "m", "position of the least load", {0.052, 0.044, 0.060}, 0.0, 0.3)},
          .evaluate = &evaluate_position_dependent_load_quadratic};
}

}  // namespace sealwatch::laws
