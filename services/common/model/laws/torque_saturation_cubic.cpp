#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// T = k_3 i^3
static LawOutput evaluate_torque_saturation_cubic(const LawInput& in) {
  const auto& i = in.signal[2];
  return {.contribution = in.parameter[0] * i * i * i, .rate = {}};
}

Law torque_saturation_cubic() {
  return {.id = "torque_saturation",
          .form = "cubic",
          .kind = SiteKind::shaft_torque,
          .equation = "k_3 i^3",
          .meaning = "the iron begins to saturate: first term of any smooth, odd torque curve",
          .energy = "0 <= 3 k_3 i^2 <= T_M at the largest current: the torque never falls with current",
          .source = "second term of the torque curve's series",
          .parameters = {strength("k_3", "N m/A3", "torque lost per cube of current",
                                  {.usual = 4e-4, .significant = 8e-5, .max = 0.02})},
          .evaluate = &evaluate_torque_saturation_cubic};
}

}  // namespace sealwatch::laws
