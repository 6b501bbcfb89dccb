// What a recording is held against before anything computes with it: the limits of one test and what the sensors of the
// plant can give (core/test_limits.hpp).
#pragma once

#include <cstddef>

#include "sealwatch/core/result.hpp"
#include "sealwatch/core/time_series.hpp"
#include "sealwatch/model/plant_description.hpp"

namespace sealwatch {

/// An Error that names row and column, with the file's row of the first sample, for a number that no sensor of that
/// channel gives, or one for a test that is too long or sampled too fast. Numbers too small to count with become zero.
[[nodiscard]] Status check_plausible(TimeSeries& samples, const PlantDescription& plant, std::size_t first_row);

}  // namespace sealwatch
