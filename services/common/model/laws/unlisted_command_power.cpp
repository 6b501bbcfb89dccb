#include "services/common/model/laws/power_law.hpp"

namespace sealwatch::laws {

// V = g_u u |u / 10 V|^a_u
static LawOutput evaluate_unlisted_command_power(const LawInput& in) {
  return {.contribution = in.parameter[0] * in.signal[1] * even_power(in.signal[1], in.parameter[1], in.rounding[0]),
          .rate = {}};
}

Law unlisted_command_power() {
  return {.id = kUnlisted,
          .form = "command_power",
          .kind = SiteKind::voltage_command,
          .equation = "g_u u abs(u / 10 V)^a_u",
          .meaning = "driver whose voltage is not proportional to its command",
          .energy = "0 <= g_u abs(u / 10 V)^a_u <= 1: what arrives is no larger than the command",
          .source = kClosedFormSource,
          .closed_form = true,
          .parameters = {strength("g_u", "1", "share of the command that is lost at 10 V",
                                  {.usual = 0.02, .significant = 3e-3, .max = 0.9}),
                         exponent("a_u", {1.0, 2.0, 0.0}, -0.5, 4.0)},
          .evaluate = &evaluate_unlisted_command_power,
          .roundings = {{"V", kCorner * kCommand_V, "10 V"}}};
}

}  // namespace sealwatch::laws
