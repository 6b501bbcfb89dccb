// What every exported model needs of the laws that an asset has: their C function, and what of them stays out.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sealwatch/core/result.hpp"
#include "services/common/equations/text_equations.hpp"
#include "services/common/model/physics_terms.hpp"

namespace sealwatch::fmi {

/// The C text around the laws: `signals` fills s[], the signals of all sites, with what has been added so far, e[].
struct LawsFrame {
  std::string head, signals, end;
  std::size_t first_site = 0;  ///< place of the plant's first site in e[]
  bool signals_see_added = false;
};

/// A function that fills e[] from `first_site` and the rates of the laws' hidden states, as RuntimeSystem::add_laws does.
[[nodiscard]] Result<std::string> laws_function(const PlantDescription& plant, const PhysicsTerms& terms,
                                                const LawsFrame& frame);

/// The signals of all sites, with 0 for those that no law in force sees: what they are made of is then not needed.
[[nodiscard]] std::vector<equations::Node> signals_seen(equations::TextEquationsParts& parts, const PhysicsTerms& terms,
                                                        std::size_t first_site);

/// Laws that belong to the recording and not to the plant, in words.
[[nodiscard]] std::vector<std::string> left_out(const PhysicsTerms& terms);

/// Base units of SI and their powers ("m", -1), as modelDescription.xml has them; nothing where a power is not whole.
[[nodiscard]] std::optional<std::vector<std::pair<std::string, int>>> whole_powers(const std::string& unit);

}  // namespace sealwatch::fmi
