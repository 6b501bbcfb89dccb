// Settings of data manipulation that hold for every asset.
#pragma once

#include <cstddef>

#include "sealwatch/core/result.hpp"

namespace sealwatch {

struct DataManipulationOptions {
  double longest_gap_s = 5.0;           ///< the window ends before a longer gap in the recording
  std::size_t least_samples = 16;       ///< fewer give no window
  double largest_offset_s = 2.0;        ///< time offsets between channels are searched for up to this
  double least_correlation = 0.97;      ///< of two channels, for an offset between them to be believed
  double least_sign_correlation = 0.8;  ///< for their signs to be compared
  double significance = 5.0;            ///< standard errors from which an offset is noticed
  double least_offset_s = 0.020;        ///< smaller offsets are within what the model of the sensors explains
  double least_offset_samples = 1.0;
  double complete_share = 0.9;  ///< of the expected duration, from which a test that ends in a stroke is no cut one
  [[nodiscard]] Status validate() const;
};

}  // namespace sealwatch
