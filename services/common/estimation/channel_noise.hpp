// Which noise and which sensor lag an estimator believes in.
#pragma once

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/time_series.hpp"

namespace sealwatch {

/// Standard deviation of one sample: what the recording says of itself, else what its data shows, but at least a
/// tenth of the asset's sensor; 0 when nobody knows.
[[nodiscard]] double noise_std_of(const AssetConfig& asset, const Series& channel);

/// First-order lag of the channel's sensor [s]; 0 when none is known.
[[nodiscard]] double time_constant_of(const AssetConfig& asset, const std::string& channel);

}  // namespace sealwatch
