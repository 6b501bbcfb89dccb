#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// V = k sgn(u) max(|u| - u_0, 0), rounded over 0.2 V
static LawOutput evaluate_driver_saturation(const LawInput& in) {
  return {.contribution = in.parameter[0] * beyond(in.signal[1], in.parameter[1], in.rounding[0]), .rate = {}};
}

Law driver_saturation() {
  return {.id = "driver_saturation",
          .form = "",
          .kind = SiteKind::voltage_command,
          .equation = "k max(abs(u) - u_0, 0) sign(u)",
          .meaning = "the drive or its supply is at its limit: only a part of larger commands takes effect",
          .energy = "0 <= k <= 1: what arrives never falls as the command grows",
          .source = "saturation; Tao, Kokotovic, Adaptive Control of Systems with Actuator Nonlinearities (1996)",
          .parameters = {strength("k", "1", "share lost of what exceeds the limit",
                                  {.usual = 1.0, .significant = 0.05, .max = 1.0}),
                         shape("u_0", "V", "limit", {10.0, 5.0, 20.0, 40.0, 80.0}, 0.1, 1000.0)},
          .evaluate = &evaluate_driver_saturation,
          .roundings = {{"V", 0.2}}};
}

}  // namespace sealwatch::laws
