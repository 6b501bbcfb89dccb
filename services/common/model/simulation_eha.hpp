// Makes the simulation of a recording with plant `eha`.
#pragma once

#include <memory>

#include "sealwatch/model/simulation.hpp"

namespace sealwatch {

[[nodiscard]] std::unique_ptr<PlantSimulation> simulate_eha(const PlantDescription& plant, const AssetConfig& asset,
                                                            const TimeSeries& recorded);

}  // namespace sealwatch
