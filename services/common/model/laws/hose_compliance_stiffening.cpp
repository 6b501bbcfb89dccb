#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// dV/dp = C_s / (1 + p / p_h), p kept positive
static LawOutput evaluate_hose_compliance_stiffening(const LawInput& in) {
  return {.contribution = in.parameter[0] / (1.0 + above_vacuum(in.signal[0], in.rounding) / in.parameter[1]),
          .rate = {}};
}

Law hose_compliance_stiffening() {
  return {.id = "hose_compliance",
          .form = "stiffening",
          .kind = SiteKind::compliance,
          .equation = "C_s / (1 + p / p_h)",
          .meaning = "a braided hose: it widens easily at first, then less and less as its braid tightens",
          .energy = "C_s >= 0: it widens with pressure",
          .source = "McCloy, Martin, Control of Fluid Power (1980): volumetric expansion of hoses",
          .parameters = {strength("C_s", "m3/Pa", "volume per pressure without pressure",
                                  {.usual = 1e-13, .significant = 8e-15, .max = 1e-10}),
                         shape("p_h", "Pa", "pressure at which it has halved", {5e6, 1e6, 2e7}, 2e5, 1e8)},
          .evaluate = &evaluate_hose_compliance_stiffening,
          .roundings = {{"Pa", kVacuum_Pa}, {"Pa", kVacuumWidth_Pa}}};
}

}  // namespace sealwatch::laws
