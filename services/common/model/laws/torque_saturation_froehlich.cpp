#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// T = k_f i |i| / (i_f + |i|): what Froehlich's curve T_M i / (1 + |i| / i_f) lacks of T_M i, where k_f = T_M.
static LawOutput evaluate_torque_saturation_froehlich(const LawInput& in) {
  const auto& i = in.signal[2];
  const auto& i_f = in.parameter[1];
  return {.contribution = in.parameter[0] * i * abs(i) / (i_f + abs(i)), .rate = {}};
}

Law torque_saturation_froehlich() {
  return {.id = "torque_saturation",
          .form = "froehlich",
          .kind = SiteKind::shaft_torque,
          .equation = "k_f i abs(i) / (i_f + abs(i))",
          .meaning = "the iron saturates gradually, even at small currents",
          .energy = "0 <= k_f <= T_M: the torque never falls with current",
          .source = "Froehlich's magnetisation curve, in Bozorth, Ferromagnetism (1951)",
          .parameters = {strength("k_f", "N m/A", "torque constant that saturates",
                                  {.usual = 0.04, .significant = 5e-3, .max = 2.0}),
                         shape("i_f", "A", "current at which half of it is lost", {10.0, 3.0, 30.0}, 0.5, 300.0)},
          .evaluate = &evaluate_torque_saturation_froehlich};
}

}  // namespace sealwatch::laws
