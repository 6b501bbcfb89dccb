#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// q = G_o sgn(p - p_0) max(|p - p_0| - p_o, 0)
static LawOutput evaluate_external_leakage_opening(const LawInput& in) {
  return {.contribution = in.parameter[0] * beyond(in.signal[0], in.parameter[1], in.rounding[0]), .rate = {}};
}

Law external_leakage_opening() {
  return {.id = "external_leakage",
          .form = "opening",
          .kind = SiteKind::outflow,
          .equation = "G_o sgn(p - p_0) max(abs(p - p_0) - p_o, 0)",
          .meaning = "oil that leaves the chamber beyond a pressure: a relief valve, or a lip that lifts",
          .energy = "G_o >= 0: oil leaks from the higher pressure to the lower",
          .source = kClosedFormSource,
          .closed_form = true,
          .parameters = {strength("G_o", "m3/(s Pa)", "flow per pressure beyond the opening",
                                  {.usual = 1e-13, .significant = 2e-14, .max = 1e-10}),
                         shape("p_o", "Pa", "pressure at which it opens", {2e6, 5e6, 1e7}, 0.0, 5e7)},
          .evaluate = &evaluate_external_leakage_opening,
          .roundings = {{"Pa", kOpening_Pa}}};
}

}  // namespace sealwatch::laws
