#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// 1/beta + alpha p_a / p^2: free air of the volume share alpha at p_a = 101325 Pa has the volume alpha p_a / p.
static LawOutput evaluate_entrained_air(const LawInput& in) {
  constexpr double kAtmosphere_Pa = 101325.0;
  const LawScalar p = above_vacuum(in.signal[0], in.rounding);
  return {.contribution = in.parameter[0] * kAtmosphere_Pa / (p * p), .rate = {}};
}

Law entrained_air() {
  return {.id = "entrained_air",
          .form = "isothermal",
          .kind = SiteKind::inverse_modulus,
          .equation = "alpha p_a / p^2",
          .meaning = "free air in the oil, compressed slowly: soft oil at low pressure",
          .energy = "alpha >= 0: air makes the oil softer",
          .source = "Merritt, Hydraulic Control Systems (1967), section 2; Gholizadeh, Burton, Schoenau (2011)",
          .parameters = {strength("alpha", "1", "volume share of free air at atmospheric pressure",
                                  {.usual = 5e-3, .significant = 1e-3, .max = 0.2})},
          .evaluate = &evaluate_entrained_air,
          .roundings = {{"Pa", kVacuum_Pa}, {"Pa", kVacuumWidth_Pa}}};
}

}  // namespace sealwatch::laws
