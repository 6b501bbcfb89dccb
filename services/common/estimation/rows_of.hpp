// A piece of a recording.
#pragma once

#include <cstddef>

#include "sealwatch/core/time_series.hpp"

namespace sealwatch {

/// Samples begin, begin + step, ... before end.
[[nodiscard]] TimeSeries rows_of(const TimeSeries& samples, std::size_t begin, std::size_t end, std::size_t step = 1);

}  // namespace sealwatch
