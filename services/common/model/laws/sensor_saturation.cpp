#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// y = channel - k max(channel - y_max, 0), applied by the simulation; k = 1: the reading stays at y_max
Law sensor_saturation() {
  return {.id = "sensor_saturation",
          .form = "",
          .kind = SiteKind::sensor_saturation,
          .equation = "channel - k max(channel - y_max, 0)",
          .meaning = "the sensor or its converter has reached the end of its range and reads too little beyond",
          .energy = "0 <= k <= 1: the reading never falls as what it measures rises",
          .source = "JCGM 200:2012, 4.7: measuring interval",
          .parameters = {strength("k", "1", "share lost of what exceeds the end of the range",
                                  {.usual = 1.0, .significant = 0.05, .max = 1.0}),
                         shape("y_max", "channel", "end of the range", {1.0}, -1e12, 1e12)}};
}

}  // namespace sealwatch::laws
