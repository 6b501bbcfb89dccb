#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// q = k max(level - level_max, 0), rounded over 0.05 V
static LawOutput evaluate_tank_overflow(const LawInput& in) {
  return {.contribution = in.parameter[0] * smooth_positive(in.signal[0] - in.parameter[1], in.rounding[0]),
          .rate = {}};
}

Law tank_overflow() {
  return {.id = "tank_overflow",
          .form = "",
          .kind = SiteKind::tank_flow,
          .equation = "k max(level - level_max, 0)",
          .meaning = "water that runs over the rim, and is lost or falls into the tank below",
          .energy = "k >= 0: water only leaves over the rim",
          .source = "Schoukens, Mattsson, Wigren, Noel, Cascaded tanks benchmark (2016)",
          .parameters = {strength("k", "1/s", "overflow per level above the rim",
                                  {.usual = 1.0, .significant = 0.05, .max = 100.0}),
                         shape("level_max", "V", "level of the rim", {10.0, 9.0, 8.0, 7.0, 12.0}, 1.0, 60.0)},
          .evaluate = &evaluate_tank_overflow,
          .roundings = {{"V", 0.05}}};
}

}  // namespace sealwatch::laws
