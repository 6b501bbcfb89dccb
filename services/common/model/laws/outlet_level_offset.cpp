#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// q = k (sqrt(level + h) - sqrt(level)), the level kept positive
static LawOutput evaluate_outlet_level_offset(const LawInput& in) {
  const LawScalar level = wetted(in.signal[0], in.rounding);
  return {.contribution = in.parameter[0] * (sqrt(level + in.parameter[1]) - sqrt(level)), .rate = {}};
}

Law outlet_level_offset() {
  return {.id = "outlet_level_offset",
          .form = "",
          .kind = SiteKind::tank_flow,
          .equation = "k (sqrt(level + h) - sqrt(level))",
          .meaning = "the outlet lies below zero level by h: water still leaves at a level of zero",
          .energy = "k >= 0: water leaves",
          .source = "Torricelli's law",
          .parameters = {strength("k", "V^0.5/s", "coefficient of the outlet",
                                  {.usual = 0.05, .significant = 5e-3, .max = 2.0}),
                         shape("h", "V", "depth of the outlet", {0.5, 0.1, 1.5}, 0.01, 5.0)},
          .evaluate = &evaluate_outlet_level_offset,
          .roundings = {{"V", 1e-6}, {"V", 0.02}}};
}

}  // namespace sealwatch::laws
