#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// u = (1 + g) u_recorded, applied by the simulation
Law input_gain() {
  return {.id = "input_gain",
          .form = "",
          .kind = SiteKind::input_gain,
          .equation = "(1 + g) u",
          .meaning = "the input that drives the plant is larger or smaller than its recording",
          .energy = "g > -1: its direction stays",
          .source = "JCGM 200:2012, 4.12",
          .parameters = {strength("g", "1", "relative change",
                                  {.usual = 0.01, .significant = 0.01, .max = 0.5, .either_sign = true})}};
}

}  // namespace sealwatch::laws
