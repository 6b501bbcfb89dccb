// Which recorded channels drive the simulation of a recording.
#pragma once

#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/time_series.hpp"

namespace sealwatch {

/// Of those, the ones that the plant describes as measured: where what drives the whole plant is not recorded, a part of
/// it is simulated, driven by what was measured at its border (the flow into a cylinder). Empty: the whole plant is.
[[nodiscard]] std::vector<std::string> measured_inputs(const AssetConfig& asset, const TimeSeries& recorded);

}  // namespace sealwatch
