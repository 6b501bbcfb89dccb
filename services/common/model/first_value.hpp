// What a recorded channel says of where a simulation starts.
#pragma once

#include <optional>
#include <string_view>

#include "sealwatch/core/time_series.hpp"

namespace sealwatch {

/// Where a channel starts: the mean of as many of its first three samples as differ by noise alone, so that one that
/// moves starts at its first sample (Lepski, Theory of Probability 35 (1990) 454). Nothing when it is not recorded.
[[nodiscard]] std::optional<double> first_value(const TimeSeries& recorded, std::string_view channel);
[[nodiscard]] std::optional<double> mean_value(const TimeSeries& recorded, std::string_view channel);

}  // namespace sealwatch
