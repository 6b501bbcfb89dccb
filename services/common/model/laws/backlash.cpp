#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// F = -F_b (1 - s^4), s = 1 - 2 g, dg/dt = -(v - |v| s^5) / b
//
// g is where the stem is in the clearance: 0 on the flank that it drives the load with in +x, 1 on the other. Motion
// carries it to the flank of its direction within a way of about b; between the flanks the load is lost. The fifth power
// keeps the flanks sharp, the fourth the loss flat between them.
static LawOutput evaluate_backlash(const LawInput& in) {
  const auto& v = in.signal[0];
  const auto& F_b = in.parameter[0];
  const auto& b = in.parameter[1];
  const LawScalar s = 1.0 - 2.0 * in.hidden;
  const LawScalar s_4 = s * s * s * s;
  return {.contribution = -F_b * (1.0 - s_4), .rate = (magnitude(v, in.rounding[0]) * s_4 * s - v) / b};
}

Law backlash() {
  return {
      .id = "backlash",
      .form = "",
      .kind = SiteKind::piston_force,
      .equation = "-F_b (1 - s^4), s = 1 - 2 g, b dg/dt = abs(v) s^5 - v",
      .meaning = "clearance between stem and load: after a reversal the load is absent until it is crossed",
      .energy = "F_b between 0 and the load: what is missing is never more than the load",
      .source = "Nordin, Gutman, Automatica 38 (2002) 1633, here smooth",
      .parameters = {strength("F_b", "N", "load that is missing in the clearance",
                              {.usual = 5e3, .significant = 600.0, .max = 1e5}),
                     shape("b", "m", "clearance", {2e-4, 5e-5, 8e-4}, 1e-5, 2e-3)},
      .hidden =
          HiddenState{
              .name = "place_in_clearance", .unit = "1", .scale = 1.0, .free_initial = true, .least = 0.0, .most = 1.0},
      .evaluate = &evaluate_backlash,
      .roundings = {{"m/s", kStandstill_m_s}}};
}

}  // namespace sealwatch::laws
