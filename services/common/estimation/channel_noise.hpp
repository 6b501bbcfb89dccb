// Which noise and which sensor lag an estimator believes in.
#pragma once

#include <span>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/time_series.hpp"

namespace sealwatch {

/// Standard deviation of one sample (signal/noise_floor.hpp), with the asset's sensor as the usual one; `time_s`: when
/// the samples were taken. Where nobody says, what the samples show, but no less than a simulation errs by.
[[nodiscard]] double noise_std_of(const AssetConfig& asset, const Series& channel, std::span<const double> time_s);
[[nodiscard]] double noise_std_of(const AssetConfig& asset, const Series& channel);

/// First-order lag of the channel's sensor [s]; 0 when none is known.
[[nodiscard]] double time_constant_of(const AssetConfig& asset, const std::string& channel);

}  // namespace sealwatch
