#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// q = G_d sgn(D) max(|D| - D_d, 0), D = p_A - p_B
static LawOutput evaluate_unlisted_leakage_opening(const LawInput& in) {
  return {.contribution = in.parameter[0] * beyond(in.signal[0], in.parameter[1], in.rounding[0]), .rate = {}};
}

Law unlisted_leakage_opening() {
  return {.id = kUnlisted,
          .form = "leakage_opening",
          .kind = SiteKind::seal_leakage,
          .equation = "G_d sgn(p_A - p_B) max(abs(p_A - p_B) - D_d, 0)",
          .meaning = "leakage past the piston beyond a pressure difference: a lip that lifts",
          .energy = "G_d >= 0: oil leaks from the higher pressure to the lower",
          .source = kClosedFormSource,
          .closed_form = true,
          .parameters = {strength("G_d", "m3/(s Pa)", "flow per pressure beyond the opening",
                                  {.usual = 1e-13, .significant = 2e-14, .max = 1e-10}),
                         shape("D_d", "Pa", "pressure at which it opens", {2e6, 5e6, 1e7}, 0.0, 5e7)},
          .evaluate = &evaluate_unlisted_leakage_opening,
          .roundings = {{"Pa", kOpening_Pa}}};
}

}  // namespace sealwatch::laws
