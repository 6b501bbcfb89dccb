// Values of the asset file that are not estimated, and may be further off than their tolerance allows (tolerance.hpp):
// a piston area that is 3 % off comes out as a sensor's gain, a slip of the pump and an offset.
//
//   alone                values are freed without any law: of those that the linearised model promises most of, the best;
//                        where that does not do, the best beside it, and so on. Each fit starts from the asset file's
//                        values, as the fit without laws may be bent too far
//   in place of laws     a value takes the place of one law found, or of several (value_swaps.hpp), then the others go
//                        that are not needed with it: a wrong value and missing physics together come out as more laws
//                        than there are; those that stay are claimed beside the value
//
// Models are compared by the criterion of the fitted recordings (criterion.hpp). Values that are 0, the mean load (each
// recording's own load is free) and what the recordings leave at a bound (1.5 times off, or that of the asset file) are
// not asked; a value that comes out within its tolerance is no cause. Nor is one fitted alone that promises, on the
// linearised model, less than a tenth of its share of what the laws explain.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sealwatch/mismatch/explanation.hpp"
#include "services/common/mismatch/refits.hpp"

namespace sealwatch::mismatch {

struct WrongDatasheet {
  std::vector<std::vector<AssetValue>> values;  ///< that these recordings cannot tell apart, the best first
  double behind = 0.0;                          ///< criterion with the first less that of what was found
  Trial with;                                   ///< the model with the first, and the laws that it leaves standing
};

/// "A_C = 0.00601 m2 instead of 0.00589 (+2.0 %), or ..."
[[nodiscard]] std::string values_in_words(const std::vector<std::vector<AssetValue>>& values);

/// What is asked: the asset as it was given, the model fitted to it without laws, and what was found beside it (laws,
/// another seal in each test), all of the same recordings.
struct DatasheetQuestion {
  const AssetConfig& asset;
  const FittedModel& baseline;
  const Trial& found;
  const Data& fit;
  int threads = 1;
};

/// At most `most` values alone. Nothing where what was found is better by more than 6.
[[nodiscard]] std::optional<WrongDatasheet> values_alone(const DatasheetQuestion& question, std::size_t most);

/// Values in place of one law or more of those found, one after the other; laws that are not needed beside them go. Nothing
/// where the laws are better by more than 6.
[[nodiscard]] std::optional<WrongDatasheet> values_in_place_of_laws(const DatasheetQuestion& question);

/// Values of the asset file that `model` has free; empty where one of them is at a bound or within its tolerance.
[[nodiscard]] std::vector<AssetValue> values_off(const FittedModel& model, const AssetConfig& asset);

}  // namespace sealwatch::mismatch
