#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// V = V_d tanh(i / i_s)
static LawOutput evaluate_driver_dead_time(const LawInput& in) {
  return {.contribution = in.parameter[0] * tanh(in.signal[0] / in.parameter[1]), .rate = {}};
}

Law driver_dead_time() {
  return {.id = "driver_dead_time",
          .form = "voltage_loss",
          .kind = SiteKind::voltage_command,
          .equation = "V_d tanh(i / i_s)",
          .meaning = "voltage lost to the bridge's dead time: a constant voltage in the direction of the current",
          .energy = "V_d >= 0: power V i is lost, never won",
          .source = "Jeong, Park, IEEE Trans. Industrial Electronics 38 (1991) 108",
          .parameters = {strength("V_d", "V", "voltage lost", {.usual = 1.0, .significant = 0.3, .max = 20.0}),
                         shape("i_s", "A", "current over which the direction changes", {0.2, 0.05, 1.0}, 0.01, 5.0)},
          .evaluate = &evaluate_driver_dead_time,
          .feeds = Feeds::motor};
}

}  // namespace sealwatch::laws
