// What these recordings could have shown, and what could hide in them.
#pragma once

#include <vector>

#include "sealwatch/mismatch/explanation.hpp"
#include "services/common/mismatch/screening.hpp"

namespace sealwatch::mismatch {

/// Smallest size of every law that would have shown, by id.
[[nodiscard]] std::vector<Power> power_of(const Screening& screening, const PlantDescription& plant);

/// Laws that would have to be larger than an engineer tolerates to show, hide in the free parameters and would move the
/// estimate of the seal's leakage.
[[nodiscard]] std::vector<const Power*> could_not_show(const std::vector<Power>& power);

}  // namespace sealwatch::mismatch
