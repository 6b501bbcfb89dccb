// Health grade of the actuator: 1 as new, 0 failed.
//
//   wear      g_s = (theta - theta_max) / (1 - theta_max), theta from leakage_resistance (ConditionSetting), within [0, 1];
//             without seal resistances 1 - d/3, d the advisory widths by which the leakage (or the hold's decay) is
//             off; where this test could not measure the leakage, the last grade; not known before a test has.
//             Of assets whose condition goes by another parameter: theta of the indicator `condition`
//   rest      g_r = 1, 0.75, 0.5, 0.25 for the worst region normal .. alarm of friction, breakaway, current, pump,
//             shaft, drive and closing time
//   grade     min(g_s, g_r), not known without g_s; 0 for a test with the verdict failed
//
// Regions have hysteresis and delay already, so that one odd test does not move g_r. The seal's part follows its
// measurement, for its trend is wanted. What only concerns sensors or the load does not lower the actuator's grade.
#pragma once

#include <optional>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/message/state_detection.hpp"
#include "services/health_assessment/deviations.hpp"

namespace sealwatch {

/// Nothing where no test has measured the seal so far.
[[nodiscard]] std::optional<double> health_grade(const AssetConfig& asset, const StateReport& report,
                                                 const std::vector<Deviation>& deviations,
                                                 std::optional<double> last_grade);

}  // namespace sealwatch
