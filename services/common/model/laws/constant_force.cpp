#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// F = F_0
static LawOutput evaluate_constant_force(const LawInput& in) { return {.contribution = in.parameter[0], .rate = {}}; }

Law constant_force() {
  return {.id = "constant_force",
          .form = "",
          .kind = SiteKind::piston_force,
          .equation = "F_0",
          .meaning = "a steady force, or a drive offset that looks like one; for plants without a load of their own",
          .energy = "none: a steady force takes and returns the same work",
          .source = "Janot, Gautier, Brunot, Data set and reference models of EMPS (2019)",
          .parameters = {strength("F_0", "N", "force against +x",
                                  {.usual = 1200.0, .significant = 600.0, .max = 1e5, .either_sign = true})},
          .evaluate = &evaluate_constant_force};
}

}  // namespace sealwatch::laws
