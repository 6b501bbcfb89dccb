// What the simulation's own errors can feign: the input's course between two samples, integration, rounding. A law must
// want more than that to count, and its strength is not known better.
//
//   k_0 = share x significant size; of a delay or lag at least 5 % of the sampling interval, unless the input is held
#pragma once

#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

struct Resolution {
  double share = 0.0;     ///< of a significant strength
  double timing_s = 0.0;  ///< of delays and lags
  const PlantDescription* plant = nullptr;

  /// k_0 of one strength in its own unit; 0 for one that goes by its channel's range (a sensor's bias).
  [[nodiscard]] double of(const LawParameter& strength) const;
};

[[nodiscard]] Resolution resolution_of(const Data& data, const PlantDescription& plant);

}  // namespace sealwatch::mismatch
