#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// D = k q_f |q_f|, dq_f/dt = (q - q_f) / 1 ms: the lag keeps the valve's flow an explicit function of the pressures.
static LawOutput evaluate_line_resistance_turbulent(const LawInput& in) {
  constexpr double kLag_s = 1e-3;
  const auto& q_f = in.hidden;
  return {.contribution = in.parameter[0] * q_f * abs(q_f), .rate = (in.signal[0] - q_f) / kLag_s};
}

Law line_resistance_turbulent() {
  return {.id = "line_resistance",
          .form = "turbulent",
          .kind = SiteKind::line_drop,
          .equation = "k q_f abs(q_f), 1 ms dq_f/dt = q - q_f",
          .meaning = "pressure drop of a fitting, a filter or a partly blocked line between port and chamber",
          .energy = "k >= 0: it always opposes the flow",
          .source = "Merritt, Hydraulic Control Systems (1967), section 3: orifices and fittings",
          .parameters = {strength("k", "Pa s2/m6", "drop per square of flow",
                                  {.usual = 3e15, .significant = 1.6e15, .max = 1e18})},
          .hidden = HiddenState{.name = "line_flow", .unit = "m3/s", .scale = 8e-6, .settled = true},
          .evaluate = &evaluate_line_resistance_turbulent};
}

}  // namespace sealwatch::laws
