// Values of the asset file that are not estimated, and may be wrong: a piston area that is 2 % off comes out as a
// sensor's gain, a slip of the pump and an offset. Those of which the linearised model promises most are freed, each by
// itself and without any law, then the best of them with another, two at most, and compared with what was found by the
// criterion of the fitted recordings (criterion.hpp).
// Where no value does by itself, the best is tried beside some of the laws: a wrong value and missing physics together
// come out as more laws than there are.
//
// Values that are 0, the mean load (each recording's own load is free) and what the recordings leave at a bound are not
// asked.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sealwatch/mismatch/explanation.hpp"
#include "services/common/mismatch/refits.hpp"

namespace sealwatch::mismatch {

struct WrongDatasheet {
  std::vector<std::vector<AssetValue>> values;  ///< that these recordings cannot tell apart, the best first
  double behind = 0.0;                          ///< criterion with the first less that of the rival
  Trial with;                                   ///< the model with the first, and the laws that it leaves standing
};

/// "A_C = 0.00601 m2 instead of 0.00589 (+2.0 %), or ..."
[[nodiscard]] std::string values_in_words(const std::vector<std::vector<AssetValue>>& values);

/// `rival`: what was found beside `baseline` (laws, another seal in each test), both fitted to `fit`. Nothing where it
/// is better than `most_values` values by more than 6.
[[nodiscard]] std::optional<WrongDatasheet> wrong_datasheet(const Trial& rival, std::size_t most_values,
                                                            const FittedModel& baseline, const Data& fit, int threads);

/// One value beside some of the rival's laws, fewer than all of them. Nothing where that is no better.
[[nodiscard]] std::optional<WrongDatasheet> wrong_datasheet_beside_laws(const Trial& rival, const FittedModel& baseline,
                                                                        const Data& fit, int threads);

}  // namespace sealwatch::mismatch
