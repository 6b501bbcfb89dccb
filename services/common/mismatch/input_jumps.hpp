// Where the input jumps between two samples, nobody knows when: the simulation interpolates, and what reacts at once is
// off for the next samples, whatever the physics. These samples do not count.
//
//   a jump    |u_(k+1) - u_k| > 8 max |u_(j+1) - u_j|, j the three intervals on either side,
//             and at least 0.5 % of the input's range
//   left out  samples k+1 and k+2, all channels; nothing where the input is held between samples, as it then is known
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sealwatch/core/time_series.hpp"
#include "sealwatch/model/plant_description.hpp"

namespace sealwatch::mismatch {

/// Samples, ascending.
[[nodiscard]] std::vector<Eigen::Index> samples_after_jumps(const TimeSeries& recorded, const PlantDescription& plant);

}  // namespace sealwatch::mismatch
