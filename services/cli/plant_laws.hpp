// Which laws of the catalogue explain tries where.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sealwatch/model/plant_description.hpp"
#include "services/common/equations/text_plant.hpp"

namespace sealwatch::cli {

/// Ids of the laws that fit a site of a built-in plant, closed forms left out.
[[nodiscard]] std::vector<std::string> laws_at(const Site& site);

/// The same for a plant as text, whose sites may lack a signal without which a law gives nothing; with the laws that the
/// plant brings itself.
[[nodiscard]] std::vector<std::string> laws_at(const equations::TextSite& site, const std::vector<Law>& own);

}  // namespace sealwatch::cli
