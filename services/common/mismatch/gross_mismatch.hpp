// Where a plant's simulation is grossly off (its free run misses the recordings by more than 20 times the noise), the
// search for single laws in the simulation gets nowhere: every parameter bends to stand in for every other, and a pump
// that does not start in the simulation has no slope. Then the balances speak first (balance_search.hpp), and the
// simulation proves: with what they found it must follow recordings that took no part, from the measured input, their
// own load and initial state alone.
//
// Noise is no measure of a model that misses by hundreds of it: residuals count against an error floor of 2 % of their
// channel's spread. Reported figures are in the noise as always.
#pragma once

#include <optional>

#include "sealwatch/mismatch/explain.hpp"
#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// Nothing where the simulation follows the recordings to 20 times their noise, or the plant has no balances.
[[nodiscard]] std::optional<Explanation> explain_gross_mismatch(const AssetConfig& asset, const Data& fit,
                                                                const Data& holdout, const ExplainOptions& options,
                                                                const Progress& progress);

}  // namespace sealwatch::mismatch
