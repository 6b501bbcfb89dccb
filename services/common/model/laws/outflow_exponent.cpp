#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// q = k (level / 1 V)^n, the level kept positive
static LawOutput evaluate_outflow_exponent(const LawInput& in) {
  return {.contribution = in.parameter[0] * exp(in.parameter[1] * log(wetted(in.signal[0], in.rounding))), .rate = {}};
}

Law outflow_exponent() {
  return {
      .id = "outflow_exponent",
      .form = "",
      .kind = SiteKind::tank_flow,
      .equation = "k (level / 1 V)^n",
      .meaning = "outflow that does not follow the square root of the level: between turbulent and laminar, or beyond",
      .energy = "k >= 0: water leaves",
      .source = "Torricelli's law with a free exponent",
      .parameters = {strength("k", "V/s", "outflow at 1 V", {.usual = 0.01, .significant = 2e-3, .max = 2.0}),
                     shape("n", "1", "exponent", {0.75, 0.25, 1.5}, 0.05, 3.0)},
      .evaluate = &evaluate_outflow_exponent,
      .roundings = {{"V", 1e-6}, {"V", 0.02}}};
}

}  // namespace sealwatch::laws
