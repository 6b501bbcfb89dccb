#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// F = c_d |v|, |v| rounded at 1e-9 m/s: half the difference between the drag towards +x and that towards -x, whose mean
// is the plant's own.
static LawOutput evaluate_directional_drag(const LawInput& in) {
  return {.contribution = in.parameter[0] * magnitude(in.signal[0], in.rounding[0]), .rate = {}};
}

Law directional_drag() {
  return {
      .id = "directional_drag",
      .form = "",
      .kind = SiteKind::piston_force,
      .equation = "c_d abs(v)",
      .meaning = "viscous friction that differs between the two directions of motion",
      .energy = "none: what it takes in one direction it returns in the other at the same speed",
      .source =
          "Olsson et al., Friction models and friction compensation (1998), section 2: friction differs by direction",
      .parameters = {strength("c_d", "N s/m", "half the difference of the drag; positive if larger towards +x",
                              {.usual = 1e6, .significant = 4e5, .max = 1e8, .either_sign = true})},
      .evaluate = &evaluate_directional_drag,
      .roundings = {{"m/s", kStandstill_m_s}}};
}

}  // namespace sealwatch::laws
