// Values of the asset file that are not estimated, and may be wrong: a piston area that is 2 % off comes out as a
// sensor's gain, a slip of the pump and an offset. Each is freed by itself, without any law, then the best of them with
// each other, two at most, and compared with the laws by the criterion of the fitted recordings (criterion.hpp):
//
//   instead   two values are as good as two or more laws, or better; one as a law alone, if it is better by 12
//   as well   they come within 6 of the laws: these recordings cannot tell them apart
//
// Values that are 0, the mean load (each recording's own load is free) and what the recordings leave at a bound are not
// asked.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/common/mismatch/refits.hpp"

namespace sealwatch::mismatch {

struct DatasheetValue {
  std::string name, unit;
  double in_asset_file = 0.0, fitted = 0.0;
};

struct WrongDatasheet {
  std::vector<DatasheetValue> values;
  bool instead = false;  ///< of the laws; else as well

  /// "A_C = 0.00601 m2 instead of 0.00589 (+2.0 %)"
  [[nodiscard]] std::string in_words() const;
};

/// `laws`: what was found beside `baseline`, both fitted to `fit`. Nothing where the laws are better by more than 6.
[[nodiscard]] std::optional<WrongDatasheet> wrong_datasheet(const Trial& laws, const FittedModel& baseline,
                                                            const Data& fit, int threads);

}  // namespace sealwatch::mismatch
