#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// q = G (p - p_0)
static LawOutput evaluate_external_leakage_laminar(const LawInput& in) {
  return {.contribution = in.parameter[0] * in.signal[0], .rate = {}};
}

Law external_leakage_laminar() {
  return {.id = "external_leakage",
          .form = "laminar",
          .kind = SiteKind::outflow,
          .equation = "G (p - p_0)",
          .meaning = "oil that leaves the chamber past the rod seal, through a narrow gap",
          .energy = "G >= 0: oil leaks from the higher pressure to the lower",
          .source = "Merritt, Hydraulic Control Systems (1967), section 3: flow in annular gaps",
          .parameters = {strength("G", "m3/(s Pa)", "flow per pressure",
                                  {.usual = 4e-14, .significant = 8e-15, .max = 1e-10})},
          .evaluate = &evaluate_external_leakage_laminar};
}

}  // namespace sealwatch::laws
