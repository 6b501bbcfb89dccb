#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// V = R_i i |i / 1 A|^a_i
static LawOutput evaluate_unlisted_resistance_power(const LawInput& in) {
  return {.contribution = in.parameter[0] * in.signal[0] * even_power(in.signal[0], in.parameter[1], in.rounding[0]),
          .rate = {}};
}

Law unlisted_resistance_power() {
  return {
      .id = kUnlisted,
      .form = "resistance_power",
      .kind = SiteKind::winding_voltage,
      .equation = "R_i i abs(i / 1 A)^a_i",
      .meaning = "voltage drop of the winding that is not proportional to the current: contacts, brushes",
      .energy = "R_i >= 0: power V i is lost, never won",
      .source = kClosedFormSource,
      .closed_form = true,
      .parameters = {strength("R_i", "ohm", "resistance at 1 A", {.usual = 0.05, .significant = 0.012, .max = 10.0}),
                     exponent("a_i", {1.0, 2.0, -0.5}, -0.9, 4.0)},
      .evaluate = &evaluate_unlisted_resistance_power,
      .roundings = {{"A", kCorner * kCurrent_A, "1 A"}}};
}

}  // namespace sealwatch::laws
