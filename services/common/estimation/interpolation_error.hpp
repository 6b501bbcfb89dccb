// What it costs that the input between two samples is not recorded.
//
// The simulation takes it as linear. With every second sample left out the simulation changes by d; a linear
// interpolation's error falls with the square of the distance, so that of the full recording is d / 3. Its rms belongs
// to the noise.
//
// That noise is not white: where an input switches between two samples, at a moment that nobody knows, everything that
// the plant stores afterwards is off. What the estimates are off by on its account is found piece by piece of the
// recording, as switches are independent of each other: d_b, the change where every second sample of piece b alone is
// left out, moves the unknowns by
//
//   delta_b = (J'J)^-1 J' d_b / noise
//
// A switch that is equally likely anywhere between its samples, T apart, has an area uncertain by T / sqrt(12); without
// every second sample that area changes by T / 2, one way or the other. So the unknowns' covariance grows by
//   sum over b of delta_b delta_b' / 3
#pragma once

#include <span>
#include <vector>

#include "services/common/estimation/pem_search.hpp"

namespace sealwatch {

/// d of every second sample [unit of the channel], samples x channels, at the optimum; without rows where the inputs
/// are held, so that nothing lies between their samples, or where it cannot be simulated.
[[nodiscard]] RowMatrix change_without_every_second_sample(const PemProblem& problem, std::size_t recording,
                                                           const PemOptimum& optimum, const AssetConfig& asset,
                                                           const TimeSeries& recorded);

/// d_b of each piece [unit of the channel], samples x channels, at the optimum; none where the inputs are known between
/// samples or do not change.
[[nodiscard]] std::vector<RowMatrix> changes_by_pieces(const PemProblem& problem, std::size_t recording,
                                                       const PemOptimum& optimum, const AssetConfig& asset,
                                                       const TimeSeries& recorded);

/// Adds each channel's interpolation error to the problem's noise. True when it matters, so that the fit is worth
/// repeating.
bool add_interpolation_error(PemProblem& problem, const PemOptimum& optimum, const AssetConfig& asset,
                             std::span<const TimeSeries> recordings);

}  // namespace sealwatch
