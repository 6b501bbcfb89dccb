// Whether a column looks as if it were in another unit than its header says.
#pragma once

#include <string>

#include "sealwatch/mismatch/explanation.hpp"
#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// A column that is outside of its plausible range for half of a recording or more, or a position and a velocity that
/// do not belong together by a factor of ten, in words; "" where there is none.
[[nodiscard]] std::string another_unit(const PlantDescription& plant, const TimeSeries& samples);

/// The channel that moves ten times less than its simulation or still less, in words; "" where none does.
[[nodiscard]] std::string hardly_moves(const PooledFit& fit);

}  // namespace sealwatch::mismatch
