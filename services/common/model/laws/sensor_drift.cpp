#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// y = channel + D (1 - exp(-t / T)), t from the recording's begin, applied by the simulation
Law sensor_drift() {
  return {.id = "sensor_drift",
          .form = "",
          .kind = SiteKind::sensor_drift,
          .equation = "channel + D (1 - exp(-t / T))",
          .meaning = "the sensor's zero moves during the recording: it warms up, or creeps",
          .energy = "none: a sensor takes no part in the physics",
          .source = "JCGM 200:2012, 4.21: instrumental drift",
          .parameters = {strength("D", "channel", "shift of the zero in the end",
                                  {.usual = 1e-6, .max = 1e9, .either_sign = true}),
                         shape("T", "s", "time in which it drifts most of the way", {5.0, 50.0}, 0.5, 1e4)}};
}

}  // namespace sealwatch::laws
