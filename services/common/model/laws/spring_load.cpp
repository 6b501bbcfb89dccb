#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// F = k x
static LawOutput evaluate_spring_load(const LawInput& in) {
  return {.contribution = in.parameter[0] * in.signal[1], .rate = {}};
}

Law spring_load() {
  return {.id = "spring_load",
          .form = "",
          .kind = SiteKind::piston_force,
          .equation = "k x",
          .meaning = "a spring that pushes towards x = 0, such as the fail-safe spring of a valve",
          .energy = "k >= 0: it stores what it takes; its preload is part of the load",
          .source = "Hooke's law",
          .parameters = {strength("k", "N/m", "stiffness", {.usual = 5e4, .significant = 3e4, .max = 1e8})},
          .evaluate = &evaluate_spring_load};
}

}  // namespace sealwatch::laws
