#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// u(t) = u_recorded(t + r (t - t_0)), applied by the simulation
Law input_clock_rate() {
  return {.id = "input_clock_rate",
          .form = "",
          .kind = SiteKind::input_clock_rate,
          .equation = "u(t (1 + r))",
          .meaning = "the clock of the recorded input is fast (r > 0) or slow against that of the measurements",
          .energy = "r > -1: time does not turn",
          .source = "ITU-T G.810 (1996), fractional frequency deviation",
          .parameters = {strength("r", "1", "relative rate",
                                  {.usual = 5e-3, .significant = 5e-3, .max = 0.2, .either_sign = true})}};
}

}  // namespace sealwatch::laws
