#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// q = k D / sqrt(|D| + w), D = p_A - p_B, w: 1 kPa in the sizes of eha
static LawOutput evaluate_turbulent_seal_leakage(const LawInput& in) {
  return {.contribution = in.parameter[0] * signed_root(in.signal[0], in.rounding[0]), .rate = {}};
}

Law turbulent_seal_leakage() {
  return {.id = "turbulent_seal_leakage",
          .form = "",
          .kind = SiteKind::seal_leakage,
          .equation = "k sgn(p_A - p_B) sqrt(abs(p_A - p_B))",
          .meaning = "leakage past the piston through a nick or a lifted lip: turbulent, unlike that of a gap",
          .energy = "k >= 0: oil leaks from the higher pressure to the lower",
          .source = "Merritt, Hydraulic Control Systems (1967), section 3: orifice flow",
          .parameters = {strength("k", "m3/(s Pa^0.5)", "flow per root of pressure",
                                  {.usual = 1e-10, .significant = 2.5e-11, .max = 1e-7})},
          .evaluate = &evaluate_turbulent_seal_leakage,
          .roundings = {{"Pa", kLaminar_Pa}}};
}

}  // namespace sealwatch::laws
