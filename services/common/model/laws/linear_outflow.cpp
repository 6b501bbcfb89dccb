#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// q = k level
static LawOutput evaluate_linear_outflow(const LawInput& in) {
  return {.contribution = in.parameter[0] * in.signal[0], .rate = {}};
}

Law linear_outflow() {
  return {.id = "linear_outflow",
          .form = "",
          .kind = SiteKind::tank_flow,
          .equation = "k level",
          .meaning = "laminar outflow of this tank, as through a long thin hose",
          .energy = "k >= 0: water leaves",
          .source = "Hagen-Poiseuille",
          .parameters = {strength("k", "1/s", "outflow per level", {.usual = 5e-3, .significant = 1e-3, .max = 1.0})},
          .evaluate = &evaluate_linear_outflow};
}

}  // namespace sealwatch::laws
