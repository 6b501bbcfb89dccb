#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// q = k_d omega
static LawOutput evaluate_speed_dependent_pump_slip_drag(const LawInput& in) {
  return {.contribution = in.parameter[0] * in.signal[1], .rate = {}};
}

Law speed_dependent_pump_slip_drag() {
  return {.id = "speed_dependent_pump_slip",
          .form = "drag",
          .kind = SiteKind::pump_slip,
          .equation = "k_d omega",
          .meaning = "oil that moving walls carry back, or chambers that do not fill: each turn delivers less",
          .energy = "0 <= k_d <= alpha_P: the pump delivers no more than it sweeps",
          .source = "Wilson, Trans. ASME 71 (1949) 115: difference of effective and geometric displacement",
          .parameters = {strength("k_d", "m3/rad", "displacement lost",
                                  {.usual = 1e-9, .significant = 4e-10, .max = 1e-6})},
          .evaluate = &evaluate_speed_dependent_pump_slip_drag};
}

}  // namespace sealwatch::laws
