#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// dV/dp = C_p (p / 10 MPa)^-b_h, p kept positive
static LawOutput evaluate_hose_compliance_power(const LawInput& in) {
  return {.contribution = in.parameter[0] * exp(-in.parameter[1] * log(above_vacuum(in.signal[0], in.rounding) *
                                                                       (kCorner / in.rounding[2]))),
          .rate = {}};
}

Law hose_compliance_power() {
  return {.id = "hose_compliance",
          .form = "power",
          .kind = SiteKind::compliance,
          .equation = "C_p (p / 10 MPa)^-b_h",
          .meaning = "a compliance that changes as a power of pressure",
          .energy = "C_p >= 0: it widens with pressure",
          .source = kClosedFormSource,
          .closed_form = true,
          .parameters = {strength("C_p", "m3/Pa", "volume per pressure at 10 MPa",
                                  {.usual = 2e-14, .significant = 4e-15, .max = 1e-10}),
                         exponent("b_h", {0.5, 1.5, -1.0}, -2.0, 3.0)},
          .evaluate = &evaluate_hose_compliance_power,
          .roundings = {{"Pa", kVacuum_Pa}, {"Pa", kVacuumWidth_Pa}, {"Pa", kCorner * kPressure_Pa, "10 MPa"}}};
}

}  // namespace sealwatch::laws
