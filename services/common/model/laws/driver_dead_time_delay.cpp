#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// V = tau_d du/dt: first term of u(t) - u(t - tau_d)
static LawOutput evaluate_driver_dead_time_delay(const LawInput& in) {
  return {.contribution = in.parameter[0] * in.signal[2], .rate = {}};
}

Law driver_dead_time_delay() {
  return {.id = "driver_dead_time",
          .form = "delay",
          .kind = SiteKind::voltage_command,
          .equation = "tau_d du/dt",
          .meaning = "the driver answers late: computing and switching take time",
          .energy = "tau_d >= 0: it answers after the command",
          .source = "first term of the delay's Taylor series",
          .parameters = {strength("tau_d", "s", "delay", {.usual = 2e-3, .significant = 1e-3, .max = 0.1})},
          .evaluate = &evaluate_driver_dead_time_delay,
          .feeds = Feeds::motor};
}

}  // namespace sealwatch::laws
