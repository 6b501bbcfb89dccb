// Laws that a plant brings as text, as laws of the catalogue (model/physics.hpp).
#pragma once

#include <optional>

#include "services/common/equations/text_plant.hpp"

namespace sealwatch::equations {

/// Nothing where something is wrong, which went to `faults`. `plant`: with its sites and sizes.
[[nodiscard]] std::optional<Law> build_law(const TextLaw& text, const TextPlant& plant, const Faults& faults);

/// Units of the parameters of the catalogue's laws that fit the sites of the plant and are not inert there: those for
/// which `law_sizes` has to give a size.
[[nodiscard]] std::vector<std::string> needed_sizes(const TextPlant& plant);

}  // namespace sealwatch::equations
