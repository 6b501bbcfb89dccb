#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// D = R q_f, dq_f/dt = (q - q_f) / 1 ms: the lag keeps the valve's flow an explicit function of the pressures.
static LawOutput evaluate_line_resistance_laminar(const LawInput& in) {
  constexpr double kLag_s = 1e-3;
  const auto& q_f = in.hidden;
  return {.contribution = in.parameter[0] * q_f, .rate = (in.signal[0] - q_f) / kLag_s};
}

Law line_resistance_laminar() {
  return {.id = "line_resistance",
          .form = "laminar",
          .kind = SiteKind::line_drop,
          .equation = "R q_f, 1 ms dq_f/dt = q - q_f",
          .meaning = "pressure drop of a long, narrow line between port and chamber",
          .energy = "R >= 0: it always opposes the flow",
          .source = "Merritt, Hydraulic Control Systems (1967), section 3: Hagen-Poiseuille",
          .parameters = {strength("R", "Pa s/m3", "resistance", {.usual = 2e10, .significant = 1e10, .max = 1e13})},
          .hidden = HiddenState{.name = "line_flow", .unit = "m3/s", .scale = 8e-6, .settled = true},
          .evaluate = &evaluate_line_resistance_laminar};
}

}  // namespace sealwatch::laws
