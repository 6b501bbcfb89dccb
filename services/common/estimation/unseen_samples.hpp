// Samples whose simulation depends on what is not recorded: around a change of sign of the flow that drives it, where the
// pump fills its ports before a valve opens (PlantPart::unseen_at_reversal_s).
//
//   from t_a - h to t_b + h    t_a: last time before a reversal that the input, averaged over 0.2 s, was beyond four times
//                              its noise, t_b: first time after it that it was so with the other sign; h:
//                              unseen_at_reversal_s
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/time_series.hpp"

namespace sealwatch {

/// Ascending; none where all that drives the simulation is recorded.
[[nodiscard]] std::vector<Eigen::Index> unseen_samples(const AssetConfig& asset, const TimeSeries& recorded);

}  // namespace sealwatch
