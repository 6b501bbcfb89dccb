#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// tau dy/dt = channel - y, applied by the simulation beside the sensor's own filter
Law sensor_lag() {
  return {
      .id = "sensor_lag",
      .form = "",
      .kind = SiteKind::sensor_lag,
      .equation = "tau dy/dt = channel - y",
      .meaning = "the sensor answers more slowly than its data sheet says: a blocked line, a wrong filter",
      .energy = "tau >= 0: it answers after the cause",
      .source = "JCGM 200:2012, 4.23",
      .parameters = {strength("tau", "s", "added time constant", {.usual = 5e-3, .significant = 5e-3, .max = 1.0})}};
}

}  // namespace sealwatch::laws
