// What a recorded channel says of where a simulation starts.
#pragma once

#include <optional>
#include <string_view>

#include "sealwatch/core/time_series.hpp"

namespace sealwatch {

/// Mean of the first three samples, or of all; nothing when the channel is not recorded.
[[nodiscard]] std::optional<double> first_value(const TimeSeries& recorded, std::string_view channel);
/// Makes the first sample alone its first value: of a recording that no noise is taken out of.
void start_at_first_sample(Series& series);
[[nodiscard]] std::optional<double> mean_value(const TimeSeries& recorded, std::string_view channel);

}  // namespace sealwatch
