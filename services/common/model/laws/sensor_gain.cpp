#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// y = (1 + g) channel, applied by the simulation
Law sensor_gain() {
  return {.id = "sensor_gain",
          .form = "",
          .kind = SiteKind::sensor_gain,
          .equation = "(1 + g) channel",
          .meaning = "the sensor's sensitivity has changed",
          .energy = "g > -1: the sensor's direction stays",
          .source = "JCGM 200:2012, 4.12",
          .parameters = {strength("g", "1", "relative change",
                                  {.usual = 0.01, .significant = 0.01, .max = 0.5, .either_sign = true})}};
}

}  // namespace sealwatch::laws
