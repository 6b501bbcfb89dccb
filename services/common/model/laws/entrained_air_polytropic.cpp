#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// 1/beta + (alpha / (n p)) (p_a / p)^(1/n): the volume of the air is alpha (p_a / p)^(1/n).
static LawOutput evaluate_entrained_air_polytropic(const LawInput& in) {
  constexpr double kAtmosphere_Pa = 101325.0;
  const LawScalar p = above_vacuum(in.signal[0], in.rounding);
  const auto& alpha = in.parameter[0];
  const auto& n = in.parameter[1];
  return {.contribution = alpha / (n * p) * exp(log(kAtmosphere_Pa / p) / n), .rate = {}};
}

Law entrained_air_polytropic() {
  return {.id = "entrained_air",
          .form = "polytropic",
          .kind = SiteKind::inverse_modulus,
          .equation = "alpha (p_a / p)^(1/n) / (n p)",
          .meaning = "free air in the oil, compressed faster than its heat can leave",
          .energy = "alpha >= 0: air makes the oil softer; 1 <= n <= 5/3",
          .source = "Gholizadeh, Burton, Schoenau, International Journal of Fluid Power 12 (2011) 7",
          .parameters = {strength("alpha", "1", "volume share of free air at atmospheric pressure",
                                  {.usual = 5e-3, .significant = 1e-3, .max = 0.2}),
                         shape("n", "1", "polytropic exponent", {1.4, 1.2}, 1.0, 1.67)},
          .evaluate = &evaluate_entrained_air_polytropic,
          .roundings = {{"Pa", kVacuum_Pa}, {"Pa", kVacuumWidth_Pa}}};
}

}  // namespace sealwatch::laws
