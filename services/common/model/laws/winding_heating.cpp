#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// V = k w i, dw/dt = (i^2 - w) / tau: resistance that grows with the winding's temperature, k w its growth.
static LawOutput evaluate_winding_heating(const LawInput& in) {
  const auto& i = in.signal[0];
  const auto& w = in.hidden;
  return {.contribution = in.parameter[0] * w * i, .rate = (i * i - w) / in.parameter[1]};
}

Law winding_heating() {
  return {.id = "winding_heating",
          .form = "",
          .kind = SiteKind::winding_voltage,
          .equation = "k w i, tau dw/dt = i^2 - w",
          .meaning = "the winding warms by its own losses and its resistance grows with temperature",
          .energy = "k >= 0: copper's resistance grows",
          .source = "heat balance of one body; 0.39 % resistance per kelvin of copper (IEC 60034-1)",
          .parameters = {strength("k", "ohm/A2", "growth of the resistance per square of current",
                                  {.usual = 2e-3, .significant = 2e-4, .max = 0.2}),
                         shape("tau", "s", "thermal time constant", {60.0, 15.0, 240.0}, 2.0, 3000.0)},
          .hidden = HiddenState{.name = "heat", .unit = "A2", .scale = 25.0},
          .evaluate = &evaluate_winding_heating};
}

}  // namespace sealwatch::laws
