#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// dV/dp = C_h
static LawOutput evaluate_hose_compliance(const LawInput& in) { return {.contribution = in.parameter[0], .rate = {}}; }

Law hose_compliance() {
  return {.id = "hose_compliance",
          .form = "constant",
          .kind = SiteKind::compliance,
          .equation = "C_h",
          .meaning = "a hose or a wall that widens with pressure and takes up oil",
          .energy = "C_h >= 0: it widens with pressure",
          .source = "Merritt, Hydraulic Control Systems (1967), section 2: elasticity of containers",
          .parameters = {strength("C_h", "m3/Pa", "volume per pressure",
                                  {.usual = 5e-14, .significant = 4e-15, .max = 1e-10})},
          .evaluate = &evaluate_hose_compliance};
}

}  // namespace sealwatch::laws
