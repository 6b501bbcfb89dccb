#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// dp = dp_f tanh((D_f - D) / p_s), dD_f/dt = (D - D_f) / tau_f: while the drop rises its lagged value is behind, and
// the friction adds to the cracking pressure; while it falls, friction keeps the poppet open.
static LawOutput evaluate_valve_hysteresis_friction(const LawInput& in) {
  constexpr double kChange_Pa = 5e3;
  const LawScalar behind = in.hidden - in.signal[0];
  return {.contribution = in.parameter[0] * tanh(behind / kChange_Pa), .rate = -behind / in.parameter[1]};
}

Law valve_hysteresis_friction() {
  return {.id = "valve_hysteresis",
          .form = "poppet_friction",
          .kind = SiteKind::valve_crack,
          .equation = "dp_f tanh((D_f - D) / 5 kPa), tau_f dD_f/dt = D - D_f",
          .meaning = "a sticking poppet: it opens above and closes below its cracking pressure",
          .energy = "dp_f between 0 and the cracking pressure: friction opposes the poppet's motion",
          .source = "Merritt, Hydraulic Control Systems (1967), section 9: relief valves with friction",
          .parameters = {strength("dp_f", "Pa", "pressure that moves the poppet against friction",
                                  {.usual = 2e4, .significant = 5e3, .max = 5e4}),
                         shape("tau_f", "s", "time constant of its memory", {0.1, 0.02, 0.5}, 5e-3, 10.0)},
          .hidden = HiddenState{.name = "lagged_drop", .unit = "Pa", .scale = 5e4, .settled = true},
          .evaluate = &evaluate_valve_hysteresis_friction};
}

}  // namespace sealwatch::laws
