// Windows: pieces of a recording that are simulated from initial states of their own, with the recording's load shared.
//
// Where the simulation integrates a noisy measured input (the cylinder circuit is driven by the recorded flow), its
// error grows like a random walk; within a window it stays below the sensors' noise. What the input's noise still adds
// is found by simulating once with as much noise again, of the same colour, and goes into the noise of the outputs:
//
//   C(lag) <- C(lag) + mean d(t) d(t + lag),   d = y(u + e) - y(u),   e: seeded noise of the input channels
//
// C: autocovariance of an output's noise, by which residuals are whitened (noise.hpp). From d is taken what the
// window's own start and load can take of it.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>

#include "services/common/mismatch/fitted_model.hpp"
#include "services/common/mismatch/noise.hpp"

namespace sealwatch::mismatch {

/// Data::resolution of recordings that are driven by a measured flow: its sensor rounds the corners of a test, and
/// friction of some 20 N fits that. A tenth of what an engineer would care about is not claimed from such an input.
inline constexpr double kMeasuredInputResolution = 0.1;

/// Length of the windows that the simulation of this recording needs, as the plant, or the part of it that is
/// simulated, says. 0: none.
[[nodiscard]] double window_of(const AssetConfig& asset, const TimeSeries& recorded);

[[nodiscard]] Data cut_into_windows(const Data& data, double window_s);

/// Of what the noise of its inputs makes of each output channel; `of_inputs`: their colours.
using InputNoise = std::map<std::string, Covariances>;
[[nodiscard]] InputNoise input_noise(const FittedModel& model, const Data& windows, const NoiseColour& of_inputs,
                                     std::uint64_t seed);
/// The model driven by inputs with as much noise again, "recorded" as it simulates without: its residuals are what the
/// inputs' noise makes.
[[nodiscard]] Result<FittedModel> feigned_by_inputs(const FittedModel& model, const Data& windows, std::uint64_t seed);
/// Adds it to the noise of `data`'s output `channels`, those of its colours.
void add_input_noise(Data& data, const AssetConfig& asset, std::span<const std::string> channels,
                     const InputNoise& noise);

}  // namespace sealwatch::mismatch
