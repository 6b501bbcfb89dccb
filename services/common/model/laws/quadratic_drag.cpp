#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// F = k v |v|; differentiable at standstill, where both v and |v| vanish.
static LawOutput evaluate_quadratic_drag(const LawInput& in) {
  const auto& v = in.signal[0];
  return {.contribution = in.parameter[0] * v * abs(v), .rate = {}};
}

Law quadratic_drag() {
  return {.id = "quadratic_drag",
          .form = "",
          .kind = SiteKind::piston_force,
          .equation = "k v abs(v)",
          .meaning = "force that grows with the square of speed: fluid pushed through narrow passages",
          .energy = "k >= 0: it always opposes the motion",
          .source = "Merritt, Hydraulic Control Systems (1967), section 3: orifice flow",
          .parameters = {strength("k", "N s2/m2", "drag", {.usual = 1e9, .significant = 3.4e8, .max = 1e12})},
          .evaluate = &evaluate_quadratic_drag};
}

}  // namespace sealwatch::laws
