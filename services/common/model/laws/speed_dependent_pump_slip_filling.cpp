#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// q = k_f omega |omega|
static LawOutput evaluate_speed_dependent_pump_slip_filling(const LawInput& in) {
  const auto& omega = in.signal[1];
  return {.contribution = in.parameter[0] * omega * abs(omega), .rate = {}};
}

Law speed_dependent_pump_slip_filling() {
  return {.id = "speed_dependent_pump_slip",
          .form = "filling",
          .kind = SiteKind::pump_slip,
          .equation = "k_f omega abs(omega)",
          .meaning = "the faster the pump turns, the less its chambers fill",
          .energy = "0 <= k_f abs(omega) <= alpha_P: the pump delivers no more than it sweeps",
          .source = "Ivantysyn, Ivantysynova, Hydrostatic Pumps and Motors (2001): square term of the loss polynomial",
          .parameters = {strength("k_f", "m3 s/rad2", "displacement lost per speed",
                                  {.usual = 5e-12, .significant = 2e-12, .max = 1e-8})},
          .evaluate = &evaluate_speed_dependent_pump_slip_filling};
}

}  // namespace sealwatch::laws
