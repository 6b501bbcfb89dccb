// Jumps of a recording where no input makes them: those of a plant with events of its own.
#pragma once

#include <cstddef>
#include <vector>

#include "sealwatch/core/time_series.hpp"
#include "sealwatch/model/simulation.hpp"

namespace sealwatch {

/// The first samples behind each; none where the simulation cannot jump by itself.
[[nodiscard]] std::vector<std::size_t> own_jumps(const PlantSimulation& simulation, const Series& channel);

/// Whether any simulated channel of the recording has one.
[[nodiscard]] bool has_own_jumps(const PlantSimulation& simulation, const TimeSeries& recorded);

}  // namespace sealwatch
