// Settings of data acquisition that hold for every asset.
#pragma once

#include <cstdint>

#include "sealwatch/core/result.hpp"

namespace sealwatch {

struct DataAcquisitionOptions {
  double time_out_s = 60.0;                 ///< live: a test without samples for this long is closed as cut
  double least_frozen_s = 0.5;              ///< a shorter constant stretch is never "frozen"
  std::uint64_t least_frozen_samples = 20;  ///< nor one of fewer samples
  double failed_share = 0.01;          ///< share of bad samples from which a channel is FAILED, below it is UNKNOWN
  double unknown_missing_share = 0.1;  ///< share of missing rows from which channels are UNKNOWN
  double gap_factor = 1.7;             ///< an interval longer than this many usual ones hides missing rows
  [[nodiscard]] Status validate() const;
};

}  // namespace sealwatch
