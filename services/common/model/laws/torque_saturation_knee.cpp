#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// T = k sgn(i) max(|i| - i_k, 0), rounded over 0.2 A
static LawOutput evaluate_torque_saturation_knee(const LawInput& in) {
  return {.contribution = in.parameter[0] * beyond(in.signal[2], in.parameter[1], in.rounding[0]), .rate = {}};
}

Law torque_saturation_knee() {
  return {.id = "torque_saturation",
          .form = "knee",
          .kind = SiteKind::shaft_torque,
          .equation = "k max(abs(i) - i_k, 0) sign(i)",
          .meaning = "the iron saturates: beyond a current the torque grows by less",
          .energy = "0 <= k <= T_M: the torque never falls with current",
          .source = "Krause, Wasynczuk, Sudhoff, Analysis of Electric Machinery: piecewise linear saturation",
          .parameters = {strength("k", "N m/A", "torque lost per current beyond the knee",
                                  {.usual = 0.04, .significant = 5e-3, .max = 2.0}),
                         shape("i_k", "A", "knee", {5.0, 2.5, 8.0}, 0.2, 100.0)},
          .evaluate = &evaluate_torque_saturation_knee,
          .roundings = {{"A", 0.2}}};
}

}  // namespace sealwatch::laws
