#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// u(t) = u_recorded(t - tau), applied by the simulation
Law input_delay() {
  return {.id = "input_delay",
          .form = "",
          .kind = SiteKind::input_delay,
          .equation = "u(t - tau)",
          .meaning = "the input acts later (tau > 0) or earlier than its recording says",
          .energy = "none: a record may be early or late",
          .source = "Ljung, System Identification, 2nd ed., 1999 (dead time n_k)",
          .parameters = {
              strength("tau", "s", "delay", {.usual = 5e-3, .significant = 5e-3, .max = 1.0, .either_sign = true})}};
}

}  // namespace sealwatch::laws
