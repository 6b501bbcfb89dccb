#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// T = A sin(N theta), d theta/dt = omega
static LawOutput evaluate_cogging_torque(const LawInput& in) {
  return {.contribution = in.parameter[0] * sine(in.parameter[1] * in.hidden), .rate = in.signal[0]};
}

Law cogging_torque() {
  return {
      .id = "cogging_torque",
      .form = "",
      .kind = SiteKind::shaft_torque,
      .equation = "A sin(N theta), dtheta/dt = omega",
      .meaning = "magnets that snap to the stator's teeth: torque that changes sign with the shaft's angle",
      .energy = "none: over a turn it takes and returns the same work",
      .source = "Zhu, Howe, IEEE Trans. Energy Conversion 15 (2000) 407",
      .parameters = {strength("A", "N m", "amplitude", {.usual = 0.02, .significant = 5e-3, .max = 2.0}),
                     shape("N", "1", "periods per turn, a whole number", {6.0, 12.0, 4.0, 8.0, 10.0, 18.0, 24.0, 36.0},
                           1.0, 120.0)},
      .hidden =
          HiddenState{.name = "shaft_angle", .unit = "rad", .scale = 1.0, .free_initial = true, .shaft_angle = true},
      .evaluate = &evaluate_cogging_torque};
}

}  // namespace sealwatch::laws
