// Laws that a plant brings as text, as laws of the catalogue (model/physics.hpp).
#pragma once

#include <optional>

#include "sealwatch/model/physics.hpp"
#include "services/common/equations/text_plant.hpp"

namespace sealwatch::equations {

/// Nothing where something is wrong, which went to `faults`. `plant`: with its sites and sizes.
[[nodiscard]] std::optional<Law> build_law(const TextLaw& text, const TextPlant& plant, const Faults& faults);

}  // namespace sealwatch::equations

namespace sealwatch {

/// The equations of a law that is written as text, for those who write it in another language. Variables: the site's
/// signals, the hidden state, the parameters, in the order of LawInput's directions.
struct LawExpressions {
  equations::Expressions expressions;
  equations::Node contribution = 0, rate = 0;
};
}  // namespace sealwatch

namespace sealwatch::equations {

/// A unit for which `law_sizes` has to give a size, and what has it in the catalogue.
struct NeededSize {
  std::string unit;
  const Law* law = nullptr;
  const LawParameter* parameter = nullptr;  ///< a strength where one has the unit
};
/// Units of the parameters of the catalogue's laws that fit the sites of the plant and are not inert there, by name.
[[nodiscard]] std::vector<NeededSize> needed_sizes(const TextPlant& plant);

}  // namespace sealwatch::equations
