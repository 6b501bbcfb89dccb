#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// q = G_t (p - p_0) / sqrt(|p - p_0| + w), w: 1 kPa in the sizes of eha
static LawOutput evaluate_external_leakage_turbulent(const LawInput& in) {
  return {.contribution = in.parameter[0] * signed_root(in.signal[0], in.rounding[0]), .rate = {}};
}

Law external_leakage_turbulent() {
  return {.id = "external_leakage",
          .form = "turbulent",
          .kind = SiteKind::outflow,
          .equation = "G_t sgn(p - p_0) sqrt(abs(p - p_0))",
          .meaning = "oil that leaves the chamber through a damaged fitting or a cracked seal",
          .energy = "G_t >= 0: oil leaks from the higher pressure to the lower",
          .source = "Merritt, Hydraulic Control Systems (1967), section 3: orifice flow",
          .parameters = {strength("G_t", "m3/(s Pa^0.5)", "flow per root of pressure",
                                  {.usual = 1e-10, .significant = 2.5e-11, .max = 1e-7})},
          .evaluate = &evaluate_external_leakage_turbulent,
          .roundings = {{"Pa", kLaminar_Pa}}};
}

}  // namespace sealwatch::laws
