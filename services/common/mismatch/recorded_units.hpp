// Whether a column looks as if it were in another unit than its header says.
#pragma once

#include <string>

#include "sealwatch/mismatch/explanation.hpp"
#include "services/common/mismatch/fitted_model.hpp"

namespace sealwatch::mismatch {

/// The column that leaves its plausible range furthest, in words; "" where all stay inside.
[[nodiscard]] std::string outside_of_its_range(const PlantDescription& plant, const Data& data);

/// The channel that moves ten times less than its simulation or still less, in words; "" where none does.
[[nodiscard]] std::string hardly_moves(const PooledFit& fit);

}  // namespace sealwatch::mismatch
