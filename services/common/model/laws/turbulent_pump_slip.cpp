#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// q = k dp / sqrt(|dp| + w), w: 1 kPa in the sizes of eha
static LawOutput evaluate_turbulent_pump_slip(const LawInput& in) {
  return {.contribution = in.parameter[0] * signed_root(in.signal[0], in.rounding[0]), .rate = {}};
}

Law turbulent_pump_slip() {
  return {.id = "turbulent_pump_slip",
          .form = "",
          .kind = SiteKind::pump_slip,
          .equation = "k sgn(p_1 - p_2) sqrt(abs(p_1 - p_2))",
          .meaning = "leakage through short, worn gaps of the pump, where flow is turbulent",
          .energy = "k >= 0: oil leaks from the higher pressure to the lower",
          .source = "Schloesser, Hydraulic Power Transmission (1961): Mathematical model for displacement pumps",
          .parameters = {strength("k", "m3/(s Pa^0.5)", "flow per root of pressure",
                                  {.usual = 6e-11, .significant = 2.5e-11, .max = 1e-7})},
          .evaluate = &evaluate_turbulent_pump_slip,
          .roundings = {{"Pa", kLaminar_Pa}}};
}

}  // namespace sealwatch::laws
