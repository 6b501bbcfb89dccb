// What it costs that the input between two samples is not recorded.
//
// The simulation takes it as linear. With every second sample left out the simulation changes by d; a linear
// interpolation's error falls with the square of the distance, so that of the full recording is d / 3. Its rms belongs
// to the noise.
#pragma once

#include <span>

#include "services/common/estimation/pem_search.hpp"

namespace sealwatch {

/// Adds each channel's interpolation error to the problem's noise. True when it matters, so that the fit is worth
/// repeating.
bool add_interpolation_error(PemProblem& problem, const PemOptimum& optimum, const AssetConfig& asset,
                             std::span<const TimeSeries> recordings);

}  // namespace sealwatch
