// Which recorded channels drive the simulation of a recording.
#pragma once

#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/time_series.hpp"

namespace sealwatch {

/// Where what drives the whole plant is not recorded, a part of it is simulated, driven by what was measured at its border
/// (the flow into a cylinder).
struct PlantPart {
  std::vector<std::string> inputs;  ///< empty: the whole plant
  double window_s = 0.0;            ///< as PlantDescription::window_s
  std::string not_recorded = {};    ///< that drives it too: no law is asked for what it may have done. Empty: nothing
  std::string record = {};          ///< what would show that
  /// It decides most before and after a change of sign of the first input: samples so near to it do not count [s].
  double unseen_at_reversal_s = 0.0;
};
[[nodiscard]] PlantPart simulated_part(const AssetConfig& asset, const TimeSeries& recorded);

}  // namespace sealwatch
