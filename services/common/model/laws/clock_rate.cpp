#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// t - t_0 = (t_recorded - t_0) / (1 + c), applied by the simulation
Law clock_rate() {
  return {.id = "clock_rate",
          .form = "",
          .kind = SiteKind::clock_rate,
          .equation = "t / (1 + c)",
          .meaning = "the recording's clock is fast (c > 0) or slow",
          .energy = "c > -1: time does not turn",
          .source = "ITU-T G.810 (1996), fractional frequency deviation",
          .parameters = {strength("c", "1", "relative rate",
                                  {.usual = 5e-3, .significant = 5e-3, .max = 0.2, .either_sign = true})}};
}

}  // namespace sealwatch::laws
