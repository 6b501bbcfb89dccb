#include "services/common/model/laws/law_files.hpp"

namespace sealwatch::laws {

// V = V_0 tanh(max(u, 0) / u_0): below about u_0 nothing arrives, above it what arrives lags the command by V_0
static LawOutput evaluate_pump_dead_voltage(const LawInput& in) {
  return {.contribution = in.parameter[0] * tanh(smooth_positive(in.signal[1], in.rounding[0]) / in.parameter[1]),
          .rate = {}};
}

Law pump_dead_voltage() {
  return {
      .id = "pump_dead_voltage",
      .form = "",
      .kind = SiteKind::voltage_command,
      .equation = "V_0 tanh(max(u, 0) / u_0)",
      .meaning = "voltage that a pump needs before it delivers: the head above it and its own friction",
      .energy = "V_0 >= 0: what arrives is smaller than the command",
      .source = "one-sided dead zone; Tao, Kokotovic, Adaptive Control of Systems with Actuator Nonlinearities (1996)",
      .parameters = {strength("V_0", "V", "voltage below which nothing is delivered",
                              {.usual = 0.5, .significant = 0.05, .max = 10.0}),
                     shape("u_0", "V", "voltage over which it is lost", {0.5, 1.5}, 0.05, 5.0)},
      .evaluate = &evaluate_pump_dead_voltage,
      .feeds = Feeds::pump,
      .roundings = {{"V", 0.02}}};
}

}  // namespace sealwatch::laws
