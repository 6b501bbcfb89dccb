#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// dp = dp_h h, dh/dt = (opening(D) - h) / tau, opening = (1 + tanh(k (D - p))) / 2
//
// p = 5e4 Pa and k = 2e-5 1/Pa are the valve's usual cracking pressure and steepness: only where the memory turns over
// depends on them.
static LawOutput evaluate(const LawInput& in) {
  constexpr double kCracking_Pa = 5e4;
  constexpr double kSteepness = 2e-5;  // 1/Pa
  const auto& h = in.hidden;
  const LawScalar opening = smooth_step(kSteepness * (in.signal[0] - kCracking_Pa));
  return {.contribution = in.parameter[0] * h, .rate = (opening - h) / in.parameter[1]};
}

Law valve_hysteresis() {
  return {.id = "valve_hysteresis",
          .form = "open_memory",
          .kind = SiteKind::valve_crack,
          .equation = "dp_h h, tau dh/dt = (1 + tanh((D - 50 kPa) / 50 kPa)) / 2 - h",
          .meaning = "the check valve, once open, closes at a lower pressure than it opened at: flow holds its poppet",
          .energy = "dp_h between 0 and the cracking pressure: the closed valve stays closed without a drop",
          .source = "Johnston, Edge, Vaughan, Proc. IMechE 205A (1991) 161: flow force on poppets",
          .parameters = {strength("dp_h", "Pa", "cracking pressure lost once open",
                                  {.usual = 2e4, .significant = 5e3, .max = 5e4}),
                         shape("tau", "s", "time in which the valve settles", {0.1, 0.02, 0.5, 2.0}, 5e-3, 10.0)},
          .hidden = HiddenState{.name = "open_memory", .unit = "1", .scale = 1.0, .settled = true},
          .evaluate = &evaluate};
}

}  // namespace sealwatch::laws
