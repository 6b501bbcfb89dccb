#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// q = -k_u level_upstream
static LawOutput evaluate(const LawInput& in) { return {.contribution = -in.parameter[0] * in.signal[1], .rate = {}}; }

Law linear_inflow() {
  return {.id = "linear_inflow",
          .form = "",
          .kind = SiteKind::tank_flow,
          .equation = "-k_u level_upstream",
          .meaning = "inflow from the tank above in proportion to its level: that tank's laminar outflow",
          .energy = "k_u between 0 and the upper tank's own: no more arrives than leaves",
          .source = "Hagen-Poiseuille",
          .parameters = {strength("k_u", "1/s", "inflow per level above",
                                  {.usual = 5e-3, .significant = 1e-3, .max = 1.0})},
          .evaluate = &evaluate,
          .elements = {"lower_tank"}};
}

}  // namespace sealwatch::laws
