// What a size of 1 in `law_sizes` stands for: a quantity of each unit on the 60 kN actuator (plant `eha`) for which the
// catalogue's laws are written. Whoever divides the usual value of his machine by it has the size to begin with.
#pragma once

#include <string>
#include <vector>

#include "services/common/equations/own_law.hpp"

namespace sealwatch::equations {

struct ReferenceQuantity {
  double value = 0.0;   ///< in the unit
  std::string meaning;  ///< "speed of its shaft"
};

/// Of the unit of `size`, in a plant with these sites: a tank's level is a voltage too. Where the actuator has no such
/// quantity, the usual value of the law that has the unit.
[[nodiscard]] ReferenceQuantity reference_quantity(const NeededSize& size, const std::vector<TextSite>& sites);

/// "about 100 rad/s (speed of its shaft)"
[[nodiscard]] std::string in_words(const ReferenceQuantity& quantity, const std::string& unit);

}  // namespace sealwatch::equations
