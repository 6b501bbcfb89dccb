// An error floor for models that miss recordings by many times their noise: what matters then is the share of a
// channel's spread, and a residual counts against the larger of noise and floor.
#pragma once

#include <map>
#include <string>

#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

inline constexpr double kErrorFloor = 0.02;  ///< of a channel's spread (standard deviation over all recordings)

using ChannelScales = std::map<std::string, double>;
[[nodiscard]] ChannelScales spread_of(const Data& data);
[[nodiscard]] Data with_error_floor(const AssetConfig& asset, Data data, const ChannelScales& spread);

/// Root mean square of all residuals over the sensors' noise.
[[nodiscard]] double rms_in_noise(const FittedModel& model, const AssetConfig& asset, const Data& data);

/// One recording, or all others.
[[nodiscard]] Data one_of(const Data& data, std::size_t k);
[[nodiscard]] Data all_but(const Data& data, std::size_t k);

}  // namespace sealwatch::mismatch
