#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// y = channel + b, applied by the simulation
Law sensor_bias() {
  return {.id = "sensor_bias",
          .form = "",
          .kind = SiteKind::sensor_bias,
          .equation = "channel + b",
          .meaning = "the sensor's zero has moved",
          .energy = "none: a sensor takes no part in the physics",
          .source = "JCGM 200:2012, 4.20",
          .parameters = {strength("b", "channel", "offset", {.usual = 1e-6, .max = 1e9, .either_sign = true})}};
}

}  // namespace sealwatch::laws
