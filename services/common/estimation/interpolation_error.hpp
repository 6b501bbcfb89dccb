// What it costs that the input between two samples is not recorded.
//
// The simulation takes it as linear. With every second sample left out the simulation changes by d; a linear
// interpolation's error falls with the square of the distance, so that of the full recording is d / 3. Its rms belongs
// to the noise.
#pragma once

#include <span>

#include "services/common/estimation/pem_search.hpp"

namespace sealwatch {

/// d of every second sample [unit of the channel], samples x channels, at the optimum; without rows where the inputs
/// are held, so that nothing lies between their samples, or where it cannot be simulated.
[[nodiscard]] RowMatrix change_without_every_second_sample(const PemProblem& problem, std::size_t recording,
                                                           const PemOptimum& optimum, const AssetConfig& asset,
                                                           const TimeSeries& recorded);

/// Adds each channel's interpolation error to the problem's noise. True when it matters, so that the fit is worth
/// repeating.
bool add_interpolation_error(PemProblem& problem, const PemOptimum& optimum, const AssetConfig& asset,
                             std::span<const TimeSeries> recordings);

}  // namespace sealwatch
