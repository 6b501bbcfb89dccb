#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// V = V_z tanh(u / u_s)
static LawOutput evaluate_driver_dead_time_zone(const LawInput& in) {
  return {.contribution = in.parameter[0] * tanh(in.signal[1] / in.parameter[1]), .rate = {}};
}

Law driver_dead_time_zone() {
  return {
      .id = "driver_dead_time",
      .form = "dead_zone",
      .kind = SiteKind::voltage_command,
      .equation = "V_z tanh(u / u_s)",
      .meaning = "the driver drops pulses shorter than its dead time: small commands have no effect",
      .energy = "V_z >= 0: what arrives is smaller than the command",
      .source = "Jeong, Park, IEEE Trans. Industrial Electronics 38 (1991) 108; rounded dead zone",
      .parameters = {strength("V_z", "V", "command without effect", {.usual = 1.0, .significant = 0.3, .max = 20.0}),
                     shape("u_s", "V", "command over which the loss builds up", {1.0, 0.2, 4.0}, 0.05, 20.0)},
      .evaluate = &evaluate_driver_dead_time_zone,
      .feeds = Feeds::motor};
}

}  // namespace sealwatch::laws
