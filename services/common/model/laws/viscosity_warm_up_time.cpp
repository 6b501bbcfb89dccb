#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// relative change = -b_t h, dh/dt = (1 - h) / tau_t: from 0 to -b_t
static LawOutput evaluate_viscosity_warm_up_time(const LawInput& in) {
  const auto& h = in.hidden;
  return {.contribution = -in.parameter[0] * h, .rate = (1.0 - h) / in.parameter[1]};
}

Law viscosity_warm_up_time() {
  return {.id = "viscosity_warm_up",
          .form = "time",
          .kind = SiteKind::viscosity,
          .equation = "-b_t h, tau_t dh/dt = 1 - h",
          .meaning = "the oil warms and thins from the start of the test, whatever the power",
          .energy = "0 <= b_t <= 0.9: oil thins as it warms, its viscosity stays positive",
          .source = "heat balance of one body at constant power",
          .parameters = {strength("b_t", "1", "share of the viscosity lost in the end",
                                  {.usual = 0.1, .significant = 0.05, .max = 0.9}),
                         shape("tau_t", "s", "thermal time constant", {30.0, 10.0, 120.0}, 1.0, 3000.0)},
          .hidden = HiddenState{.name = "warmth", .unit = "1", .scale = 1.0},
          .evaluate = &evaluate_viscosity_warm_up_time};
}

}  // namespace sealwatch::laws
