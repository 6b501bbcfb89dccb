#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// dp = dp_h h, dh/dt = (opening(D) - h) / tau, opening = (1 + tanh(k (D / D_o - 1))) / 2
//
// k = 2: the memory turns over within D_o / 2 about D_o, which may lie below the valve's cracking pressure, as its
// orifice leaks before it opens.
static LawOutput evaluate_valve_hysteresis(const LawInput& in) {
  constexpr double kSteepness = 2.0;
  const auto& h = in.hidden;
  const auto &dp_h = in.parameter[0], &tau = in.parameter[1], &D_o = in.parameter[2];
  const LawScalar opening = smooth_step(kSteepness * (in.signal[0] / D_o - 1.0));
  return {.contribution = dp_h * h, .rate = (opening - h) / tau};
}

Law valve_hysteresis() {
  return {.id = "valve_hysteresis",
          .form = "open_memory",
          .kind = SiteKind::valve_crack,
          .equation = "dp_h h, tau dh/dt = (1 + tanh(2 D / D_o - 2)) / 2 - h",
          .meaning = "the check valve closes at a lower pressure than it opens at: the flow holds its poppet",
          .energy = "dp_h between 0 and the cracking pressure: the closed valve stays closed without a drop",
          .source = "Johnston, Edge, Vaughan, Proc. IMechE 205A (1991) 161: flow force on poppets",
          .parameters = {strength("dp_h", "Pa", "cracking pressure lost once open",
                                  {.usual = 2e4, .significant = 5e3, .max = 5e4}),
                         shape("tau", "s", "time in which the valve settles", {0.1, 0.02, 0.5, 2.0}, 5e-3, 10.0),
                         shape("D_o", "Pa", "drop at which it opens", {5e4, 2e4}, 5e3, 1e5)},
          .hidden = HiddenState{.name = "open_memory", .unit = "1", .scale = 1.0, .settled = true},
          .evaluate = &evaluate_valve_hysteresis};
}

}  // namespace sealwatch::laws
