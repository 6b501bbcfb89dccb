// A start for a simulation that is far off: the plant's balances with the recorded states put in.
//
// A free run adds up what its parameters are off by: it may run away before it ends, and no slope leads back from there. A
// piece of a recording that begins at a recorded state stays near it, whatever the parameters are:
//
//   x(t + h) - x(t) = integral over the piece of f(x, u, p)        h: 1/32 of the recording, then 1/4
//
// Where the plant jumps by itself h is an eighth of the way from jump to jump at first, then twice as long again and
// again: a wrong value moves a jump by few samples only as long as few jumps came before it, and the sum of squares
// has a minimum of its own wherever one of them is at another sample.
//
// Each state of a piece that is not settled is an unknown of its own where it begins, so that recorded states need no
// smoothing and states that are not recorded follow from those that are. Where the pieces' fit ends, that of the whole
// recordings sets out. Any plant has that: it takes its simulation alone.
#pragma once

#include <optional>

#include "services/common/estimation/pem_search.hpp"

namespace sealwatch {

/// Nothing where pieces cannot be simulated, or where the recordings are pieces themselves.
[[nodiscard]] std::optional<PemPoint> piecewise_start(const PemProblem& problem, const AssetConfig& asset,
                                                      std::span<const TimeSeries> recordings,
                                                      const ActuatorFitOptions& options);

}  // namespace sealwatch
