// Ranges that nobody gave. A parameter without `min` and `max` may be a tenth to ten times its value, which is no
// knowledge of the plant: where a fit ends at an end of such a range and misses grossly, it goes on beyond it.
#pragma once

#include <string>
#include <vector>

#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// The model fitted with ranges ten times as wide where it is at their ends, as often as that leaves less than half of its
/// misfit. `model`: fitted to `data`.
[[nodiscard]] FittedModel beyond_usual_ranges(FittedModel model, const Data& data, int threads);

/// A sentence for each parameter whose range was widened beyond what is `given`.
[[nodiscard]] std::vector<std::string> wider_ranges_in_words(const AssetConfig& fitted, const AssetConfig& given);

}  // namespace sealwatch::mismatch
