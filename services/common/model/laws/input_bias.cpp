#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// u = u_recorded + b, applied by the simulation
Law input_bias() {
  return {.id = "input_bias",
          .form = "",
          .kind = SiteKind::input_bias,
          .equation = "u + b",
          .meaning = "the input that drives the plant is offset from its recording",
          .energy = "none: a record takes no part in the physics",
          .source = "JCGM 200:2012, 4.20",
          .parameters = {strength("b", "channel", "offset", {.usual = 1e-6, .max = 1e9, .either_sign = true})}};
}

}  // namespace sealwatch::laws
