#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// F = F_b exp(-((x - x_b) / w_b)^2)
static LawOutput evaluate_position_dependent_load_bump(const LawInput& in) {
  const auto& x = in.signal[1];
  const auto& F_b = in.parameter[0];
  const auto& x_b = in.parameter[1];
  const auto& w_b = in.parameter[2];
  return {.contribution = F_b * bell((x - x_b) / w_b), .rate = {}};
}

Law position_dependent_load_bump() {
  return {.id = "position_dependent_load",
          .form = "bump",
          .kind = SiteKind::piston_force,
          .equation = "F_b exp(-((x - x_b) / w_b)^2)",
          .meaning = "load that rises or falls around one position",
          .energy = "none: a function of position alone takes and returns the same work",
          .source = "potential force; local basis function",
          .parameters = {strength("F_b", "N", "load at the position",
                                  {.usual = 2e3, .significant = 600.0, .max = 1e5, .either_sign = true}),
                         place("x_b", {0.052, 0.047, 0.057, 0.042, 0.062}),
                         shape("w_b", "m", "half width", {4e-3, 1.5e-3, 1e-2}, 5e-4, 0.1)},
          .evaluate = &evaluate_position_dependent_load_bump};
}

}  // namespace sealwatch::laws
