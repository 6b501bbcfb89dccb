#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// relative change = -b tanh(h), dh/dt = (P / 100 W - h) / tau: about -b h, and never below -b.
static LawOutput evaluate_viscosity_warm_up_dissipation(const LawInput& in) {
  constexpr double kReference_W = 100.0;
  const auto& h = in.hidden;
  return {.contribution = -in.parameter[0] * tanh(h), .rate = (in.signal[0] / kReference_W - h) / in.parameter[1]};
}

Law viscosity_warm_up_dissipation() {
  return {.id = "viscosity_warm_up",
          .form = "dissipation",
          .kind = SiteKind::viscosity,
          .equation = "-b tanh(h), tau dh/dt = P / 100 W - h",
          .meaning = "the dissipated power warms and thins the oil: less viscous friction, more laminar leakage",
          .energy = "0 <= b <= 0.9: oil thins as it warms, its viscosity stays positive",
          .source = "heat balance of one body; Merritt, Hydraulic Control Systems (1967), section 2: viscosity",
          .parameters = {strength("b", "1", "share of the viscosity lost to warming by 100 W",
                                  {.usual = 0.1, .significant = 0.05, .max = 0.9}),
                         shape("tau", "s", "thermal time constant", {30.0, 10.0, 120.0}, 1.0, 3000.0)},
          .hidden = HiddenState{.name = "warmth", .unit = "1", .scale = 1.0},
          .evaluate = &evaluate_viscosity_warm_up_dissipation};
}

}  // namespace sealwatch::laws
