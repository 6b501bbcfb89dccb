#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// q = G_r sgn(D) max(|D| - D_r, 0), D = p_1 - p_2
static LawOutput evaluate_unlisted_slip_opening(const LawInput& in) {
  return {.contribution = in.parameter[0] * beyond(in.signal[0], in.parameter[1], in.rounding[0]), .rate = {}};
}

Law unlisted_slip_opening() {
  return {.id = kUnlisted,
          .form = "slip_opening",
          .kind = SiteKind::pump_slip,
          .equation = "G_r sgn(p_1 - p_2) max(abs(p_1 - p_2) - D_r, 0)",
          .meaning = "leakage of the pump beyond a pressure difference: a relief valve, or plates that part",
          .energy = "G_r >= 0: oil leaks from the higher pressure to the lower",
          .source = kClosedFormSource,
          .closed_form = true,
          .parameters = {strength("G_r", "m3/(s Pa)", "flow per pressure beyond the opening",
                                  {.usual = 1e-13, .significant = 2e-14, .max = 1e-10}),
                         shape("D_r", "Pa", "pressure at which it opens", {2e6, 5e6, 1e7}, 0.0, 5e7)},
          .evaluate = &evaluate_unlisted_slip_opening,
          .roundings = {{"Pa", kOpening_Pa}}};
}

}  // namespace sealwatch::laws
