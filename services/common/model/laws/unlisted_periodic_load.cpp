#include <numbers>

#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// F = A_s sin(2 pi (x - 50 mm) / L_x) + A_c cos(2 pi (x - 50 mm) / L_x)
static LawOutput evaluate_unlisted_periodic_load(const LawInput& in) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const LawScalar angle = kTurn * (in.signal[1] - kPosition_m) / in.parameter[2];
  return {.contribution = in.parameter[0] * sine(angle) + in.parameter[1] * sine(angle + 0.25 * kTurn), .rate = {}};
}

Law unlisted_periodic_load() {
  return {.id = kUnlisted,
          .form = "periodic_load",
          .kind = SiteKind::piston_force,
          .equation = "A_s sin(2 pi (x - 50 mm) / L_x) + A_c cos(2 pi (x - 50 mm) / L_x)",
          .meaning = "load that repeats along the stroke: a thread, a rack, a screw",
          .energy = "none: a function of position alone takes and returns the same work",
          .source = kClosedFormSource,
          .closed_form = true,
          .parameters = {strength("A_s", "N", "amplitude of the sine",
                                  {.usual = 1e3, .significant = 600.0, .max = 1e5, .either_sign = true}),
                         strength("A_c", "N", "amplitude of the cosine",
                                  {.usual = 1e3, .significant = 600.0, .max = 1e5, .either_sign = true}),
                         shape("L_x", "m", "period", {4e-3, 2e-3, 8e-3}, 5e-4, 0.1)},
          .evaluate = &evaluate_unlisted_periodic_load};
}

}  // namespace sealwatch::laws
