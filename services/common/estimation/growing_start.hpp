// A start for a simulation that runs out of step with the recording: its beginning first, then more and more of it.
//
// What swings or bounces has its zero crossings and impacts at times that its parameters move. Where a wrong parameter
// has added up to half a swing, or an impact lies beyond the next sample, the sum of squares has minima of its own and no
// slope leads to the right one. Over a short beginning nothing has added up yet:
//
//   psi_j = argmin over the first 1.5^j / 16 of each recording, started from psi_(j-1)        j = 0, 1, ... 6
//
// Unlike pieces (piecewise_start.hpp) beginnings need no state in the middle: a unit that hides its states has them too.
#pragma once

#include <optional>

#include "services/common/estimation/pem_search.hpp"

namespace sealwatch {

/// Nothing where a beginning cannot be simulated, or where the recordings are pieces.
[[nodiscard]] std::optional<PemPoint> growing_start(const PemProblem& problem, const AssetConfig& asset,
                                                    std::span<const TimeSeries> recordings,
                                                    const ActuatorFitOptions& options);

}  // namespace sealwatch
