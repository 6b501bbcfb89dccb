#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// q = k |omega| dp, |omega| rounded over 1 rad/s
static LawOutput evaluate_speed_dependent_pump_slip_rising(const LawInput& in) {
  return {.contribution = in.parameter[0] * smooth_abs(in.signal[1], in.rounding[0]) * in.signal[0], .rate = {}};
}

Law speed_dependent_pump_slip_rising() {
  return {.id = "speed_dependent_pump_slip",
          .form = "rising",
          .kind = SiteKind::pump_slip,
          .equation = "k abs(omega) (p_1 - p_2)",
          .meaning = "leakage of the pump that grows with speed, or oil that is compressed in each stroke",
          .energy = "k >= 0: oil leaks from the higher pressure to the lower",
          .source = "Ivantysyn, Ivantysynova, Hydrostatic Pumps and Motors (2001): mixed term of the loss polynomial",
          .parameters = {strength("k", "m3/(rad Pa)", "flow per speed and pressure",
                                  {.usual = 1e-16, .significant = 4e-17, .max = 1e-12})},
          .evaluate = &evaluate_speed_dependent_pump_slip_rising,
          .roundings = {{"rad/s", 1.0}}};
}

}  // namespace sealwatch::laws
