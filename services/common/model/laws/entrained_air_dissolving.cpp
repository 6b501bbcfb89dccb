#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// 1/beta + alpha p_a / p^2 (1 - tanh((p - p_d) / (p_d / 4))) / 2: above p_d the air has dissolved.
static LawOutput evaluate_entrained_air_dissolving(const LawInput& in) {
  constexpr double kAtmosphere_Pa = 101325.0;
  const LawScalar p = above_vacuum(in.signal[0], in.rounding);
  const auto& p_d = in.parameter[1];
  const LawScalar free_share = smooth_step(4.0 * (p_d - p) / p_d);
  return {.contribution = in.parameter[0] * kAtmosphere_Pa / (p * p) * free_share, .rate = {}};
}

Law entrained_air_dissolving() {
  return {.id = "entrained_air",
          .form = "dissolving",
          .kind = SiteKind::inverse_modulus,
          .equation = "alpha p_a / p^2 (1 - tanh(4 (p - p_d) / p_d)) / 2",
          .meaning = "free air in the oil that dissolves above some pressure",
          .energy = "alpha >= 0: air makes the oil softer",
          .source = "Yu, Chen, Lu, Journal of Dynamic Systems, Measurement, and Control 116 (1994) 146",
          .parameters = {strength("alpha", "1", "volume share of free air at atmospheric pressure",
                                  {.usual = 5e-3, .significant = 1e-3, .max = 0.2}),
                         shape("p_d", "Pa", "pressure at which half has dissolved", {3e6, 1.5e6, 8e6}, 3e5, 3e7)},
          .evaluate = &evaluate_entrained_air_dissolving,
          .roundings = {{"Pa", kVacuum_Pa}, {"Pa", kVacuumWidth_Pa}}};
}

}  // namespace sealwatch::laws
