// Where the mismatch sits: a drawing of the plant, each element coloured by the probability that it is the one.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "sealwatch/mismatch/explanation.hpp"
#include "sealwatch/model/plant_description.hpp"

namespace sealwatch::report {

/// Inline SVG. Plant `eha` as a schematic of the closed circuit with all its sensors; any other plant as a chain of
/// boxes, one for each element of its description, with its sensors below. Elements that the data cannot tell from the
/// most probable one are outlined. Channels that are not `recorded` are drawn faintly.
[[nodiscard]] std::string actuator_drawing(const PlantDescription& plant, std::span<const mismatch::Location> location,
                                           const std::vector<std::string>& recorded);

}  // namespace sealwatch::report
