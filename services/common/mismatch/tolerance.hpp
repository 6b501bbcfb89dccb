// Fixed values of an asset are known within a tolerance: each is one more unknown of every fit, with the prior
// N(value, tolerance^2), and costs nothing within it (kWithinTolerance). "Beyond
// tolerance" is a cause like a law (datasheet.hpp).
//
// Only values that show take part: those whose change by one tolerance would raise the misfit by more than a quarter
// though everything that is estimated gives way,
//
//   tolerance^2 (G_cc - G_cb G_bb^-1 G_bc) > 1/4
//
// c: the value, b: what is estimated, G: normal matrix of all recordings. The others could be anything within theirs
// without a trace.
#pragma once

#include <vector>

#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// Times: further off, a fixed value is not wrong but another's.
inline constexpr double kOffByAtMost = 1.5;

/// Every fixed value that is not 0, with the asset's tolerance or the plant's; not the mean load, which each recording
/// has for itself.
[[nodiscard]] std::vector<KnownValue> known_values(const AssetConfig& asset, const PlantDescription& plant);

/// Those of `known` that show in these recordings, at `model`; none where the model cannot be linearised.
[[nodiscard]] std::vector<KnownValue> that_show(const std::vector<KnownValue>& known, const FittedModel& model,
                                                const Data& data, int threads);

}  // namespace sealwatch::mismatch
