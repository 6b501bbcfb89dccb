#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// T = k |dp| tanh(omega / omega_s), |dp| rounded over 1e4 Pa
static LawOutput evaluate_pressure_dependent_shaft_friction(const LawInput& in) {
  const auto& omega = in.signal[0];
  const auto& dp = in.signal[1];
  return {.contribution = in.parameter[0] * smooth_abs(dp, in.rounding[0]) * tanh(omega / in.parameter[1]), .rate = {}};
}

Law pressure_dependent_shaft_friction() {
  return {
      .id = "pressure_dependent_shaft_friction",
      .form = "",
      .kind = SiteKind::shaft_torque,
      .equation = "k abs(p_1 - p_2) tanh(omega / omega_s)",
      .meaning = "friction of pump parts that the pressure presses together: the pump's torque loss under load",
      .energy = "k >= 0: it always opposes the rotation",
      .source = "McCandlish, Dorey, Proc. IMechE 198B (1984) 165",
      .parameters = {strength("k", "m3/rad", "torque per pressure, a share of the displacement",
                              {.usual = 2e-9, .significant = 4e-10, .max = 1e-6}),
                     shape("omega_s", "rad/s", "speed over which the direction changes", {2.0, 0.5, 10.0}, 0.05, 50.0)},
      .evaluate = &evaluate_pressure_dependent_shaft_friction,
      .roundings = {{"Pa", 1e4}}};
}

}  // namespace sealwatch::laws
