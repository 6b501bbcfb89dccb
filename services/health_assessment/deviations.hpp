// How far each judged quantity of a test is off, in advisory widths.
//
//   centre = 2 advisory - warning,  width = |warning - advisory|
//   d      = (value - centre) / width          |d| = 1 at the advisory limit, 2 at the warning limit
//
// For limits about the asset's own baseline the centre is the baseline's mean, and a width is at least a 99.9 %
// prediction interval. Limits have one side only where the other side is no fault: there d is 0, and where the limit is
// fixed it is not known either what the quantity usually is, so that the deviation is not informative.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sealwatch/message/state_detection.hpp"

namespace sealwatch {

struct Deviation {
  RegionJudgement judgement;
  double width = 0.0;  ///< of one advisory width, in the quantity's unit
  double value = 0.0;  ///< d
  bool informative = true;
};

/// Deviations of the quantities that the fault signatures speak of: indicators, not residuals or channels.
[[nodiscard]] std::vector<Deviation> deviations_of(const StateReport& report);

[[nodiscard]] const Deviation* find_deviation(const std::vector<Deviation>& deviations, std::string_view quantity);

/// "pump slip 3.1e-14 m3/(s Pa), advisory above 2.6e-14"
[[nodiscard]] std::string in_words(const RegionJudgement& judgement);

}  // namespace sealwatch
