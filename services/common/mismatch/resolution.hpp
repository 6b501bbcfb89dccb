// What the simulation's own errors can feign: the input's course between two samples, integration, rounding. A law must
// want more than that to count, and its strength is not known better.
//
//   k_0 = share x significant size; of a delay or lag at least 5 % of the sampling interval, unless the input is held
//
// Simulations whose inputs are known err by less than the noise: there k_0 is no more than the strength that moves the
// outputs by as much, whatever size a plant's file has for it.
#pragma once

#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

struct Resolution {
  double share = 0.0;     ///< of a significant strength
  double timing_s = 0.0;  ///< of delays and lags
  const PlantDescription* plant = nullptr;
  bool inputs_are_known = false;  ///< neither measured nor moving between the samples

  /// k_0 of one strength in its own unit; 0 for one that goes by its channel's range (a sensor's bias). `moved`: root mean
  /// square by which one unit of it moves the outputs, over their noise; 0: not known.
  [[nodiscard]] double of(const LawParameter& strength, double moved) const;
};

/// That root mean square of a shared unknown of a fitted model.
[[nodiscard]] double outputs_moved_by(const FittedModel& model, std::size_t unknown);

[[nodiscard]] Resolution resolution_of(const Data& data, const PlantDescription& plant);

}  // namespace sealwatch::mismatch
