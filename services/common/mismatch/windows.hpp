// Windows: pieces of a recording that are simulated from initial states of their own, with the recording's load shared.
//
// Where the simulation integrates a noisy measured input (the cylinder circuit is driven by the recorded flow), its
// error grows like a random walk; within a window it stays below the sensors' noise. What the input's noise still adds is
// found by simulating once with as much noise again, and goes into the noise of the outputs:
//
//   sigma^2 <- sigma^2 + mean (y(u + e) - y(u))^2,   e: seeded noise of the input channels
#pragma once

#include <cstdint>

#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// Data::resolution of recordings that are driven by a measured flow: its sensor rounds the corners of a test, and
/// friction of some 20 N fits that. A tenth of what an engineer would care about is not claimed from such an input.
inline constexpr double kMeasuredInputResolution = 0.1;

/// Length of the windows that the simulation of this recording needs, as the plant, or the part of it that is simulated,
/// says. 0: none.
[[nodiscard]] double window_of(const AssetConfig& asset, const TimeSeries& recorded);

[[nodiscard]] Data cut_into_windows(const Data& data, double window_s);

/// Raises noise_std of `data`'s output channels by what the noise of its inputs makes of them.
void add_input_noise(Data& data, const FittedModel& model, const Data& windows, std::uint64_t seed);

}  // namespace sealwatch::mismatch
