#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// q = G_l (p_A - p_B) exp(-((x - x_l) / w_l)^2)
static LawOutput evaluate_unlisted_local_leakage(const LawInput& in) {
  const auto& [G_l, x_l, w_l, none] = in.parameter;
  return {.contribution = G_l * in.signal[0] * bell((in.signal[2] - x_l) / w_l), .rate = {}};
}

Law unlisted_local_leakage() {
  return {
      .id = kUnlisted,
      .form = "local_leakage",
      .kind = SiteKind::seal_leakage,
      .equation = "G_l (p_A - p_B) exp(-((x - x_l) / w_l)^2)",
      .meaning = "leakage past the piston around one position: a score or wear of the bore",
      .energy = "G_l >= 0: oil leaks from the higher pressure to the lower",
      .source = kClosedFormSource,
      .closed_form = true,
      .parameters = {strength("G_l", "m3/(s Pa)", "flow per pressure at the position",
                              {.usual = 3e-14, .significant = 8e-15, .max = 1e-11}),
                     place("x_l", {0.052, 0.047, 0.057}), shape("w_l", "m", "half width", {4e-3, 1.5e-3}, 5e-4, 0.1)},
      .evaluate = &evaluate_unlisted_local_leakage};
}

}  // namespace sealwatch::laws
