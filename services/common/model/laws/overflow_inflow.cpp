#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// q = -k max(level_upstream - level_max, 0), rounded over 0.05 V
static LawOutput evaluate(const LawInput& in) {
  return {.contribution = -in.parameter[0] * smooth_positive(in.signal[1] - in.parameter[1], 0.05), .rate = {}};
}

Law overflow_inflow() {
  return {.id = "overflow_inflow",
          .form = "",
          .kind = SiteKind::tank_flow,
          .equation = "-k max(level_upstream - level_max, 0)",
          .meaning = "the part of the upper tank's overflow that this tank catches",
          .energy = "k between 0 and the upper tank's own: no more is caught than runs over",
          .source = "Schoukens, Mattsson, Wigren, Noel, Cascaded tanks benchmark (2016)",
          .parameters = {strength("k", "1/s", "inflow per level above the upper rim",
                                  {.usual = 0.5, .significant = 0.05, .max = 100.0}),
                         shape("level_max", "V", "level of the upper tank's rim", {10.0, 9.5, 9.0, 8.0}, 1.0, 20.0)},
          .evaluate = &evaluate,
          .elements = {"lower_tank"}};
}

}  // namespace sealwatch::laws
