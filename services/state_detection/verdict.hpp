// The verdict on one partial stroke test, with its reasons in words.
//
//   aborted     the test was given up, by the sender's word
//   not_judged  what was recorded does not tell: begun inside the stroke, cut before its end, no partial stroke
//               test, or neither position nor velocity in order
//   failed      less than 95 % of the stroke was reached, the piston did not come back to within 5 % of the stroke, or
//               the full stroke extrapolated from the speed in the closing direction takes longer than allowed
//   passed      none of these
// The last reason says what the stroke was judged by: the position, or, where that is FAILED or missing, the velocity,
// integrated.
#pragma once

#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/message/data_manipulation.hpp"
#include "sealwatch/message/state_detection.hpp"

namespace sealwatch {

struct Verdict {
  PstVerdict verdict = PstVerdict::not_judged;
  std::vector<std::string> reasons;
};

/// `indicators` as condition_indicators gives them for the same test.
[[nodiscard]] Verdict judge_test(const AssetConfig& asset, const TestFeatures& features, const TestWindow& window,
                                 const std::vector<Quantity>& indicators);

}  // namespace sealwatch
