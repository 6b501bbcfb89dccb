#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// D = D_q sgn(q_f) |q_f / 1e-5 m3/s|^a_q, dq_f/dt = (q - q_f) / 1 ms: as in line_resistance_laminar.cpp.
static LawOutput evaluate_line_resistance_power(const LawInput& in) {
  constexpr double kLag_s = 1e-3;
  const auto& q_f = in.hidden;
  return {.contribution = in.parameter[0] * signed_power(q_f, in.parameter[1], in.rounding[0]),
          .rate = (in.signal[0] - q_f) / kLag_s};
}

Law line_resistance_power() {
  return {.id = "line_resistance",
          .form = "power",
          .kind = SiteKind::line_drop,
          .equation = "D_q sgn(q_f) abs(q_f / 1e-5 m3/s)^a_q, 1 ms dq_f/dt = q - q_f",
          .meaning = "pressure drop between port and chamber that follows a power of the flow",
          .energy = "D_q >= 0: it always opposes the flow",
          .source = kClosedFormSource,
          .closed_form = true,
          .parameters = {strength("D_q", "Pa", "drop at 1e-5 m3/s", {.usual = 2e5, .significant = 1e5, .max = 1e8}),
                         exponent("a_q", {1.5, 3.0}, 0.5, 5.0)},
          .hidden = HiddenState{.name = "line_flow", .unit = "m3/s", .scale = 8e-6, .settled = true},
          .evaluate = &evaluate_line_resistance_power,
          .roundings = {{"m3/s", kCorner * kFlow_m3_s, "1e-5 m3/s"}}};
}

}  // namespace sealwatch::laws
