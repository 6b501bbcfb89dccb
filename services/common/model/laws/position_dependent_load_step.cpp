#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// F = F_s (1 + tanh((x - x_s) / w_s)) / 2
static LawOutput evaluate_position_dependent_load_step(const LawInput& in) {
  const auto& x = in.signal[1];
  const auto& F_s = in.parameter[0];
  const auto& x_s = in.parameter[1];
  const auto& w_s = in.parameter[2];
  return {.contribution = F_s * smooth_step((x - x_s) / w_s), .rate = {}};
}

Law position_dependent_load_step() {
  return {.id = "position_dependent_load",
          .form = "step",
          .kind = SiteKind::piston_force,
          .equation = "F_s (1 + tanh((x - x_s) / w_s)) / 2",
          .meaning = "load that is different beyond a position: a second spring, a gate that leaves its seat",
          .energy = "none: a function of position alone takes and returns the same work",
          .source = "potential force; rounded step",
          .parameters = {strength("F_s", "N", "load beyond the position",
                                  {.usual = 2e3, .significant = 600.0, .max = 1e5, .either_sign = true}),
                         shape("x_s", "m", "position", {0.052, 0.047, 0.057}, 0.0, 0.3),
                         shape("w_s", "m", "half width of the step", {1e-3, 4e-3}, 2e-4, 0.05)},
          .evaluate = &evaluate_position_dependent_load_step};
}

}  // namespace sealwatch::laws
