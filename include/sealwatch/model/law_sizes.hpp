// The catalogue's laws in the sizes of a plant: usual sizes, bounds, what matters and the widths of rounded corners are
// written for `eha`, and each grows with its unit (PlantDescription::law_sizes).
#pragma once

#include <string>

#include "sealwatch/model/physics.hpp"
#include "sealwatch/model/plant_description.hpp"

namespace sealwatch {

struct LawBounds {
  double min = 0.0;
  double max = 0.0;
};

/// By what the numbers of a law's parameter are multiplied in a plant; 1 for a law of the plant's own.
[[nodiscard]] double law_size(const PlantDescription& plant, const LawParameter& parameter);
[[nodiscard]] LawBounds law_bounds(const PlantDescription& plant, const LawParameter& parameter);
/// One of the parameter's start values, the usual one first, within its bounds.
[[nodiscard]] double law_start(const PlantDescription& plant, const LawParameter& parameter, std::size_t which = 0);
/// Size of a strength from which an engineer would care.
[[nodiscard]] double significant_size(const PlantDescription& plant, const LawParameter& strength);
/// A width whose unit the plant gives no size for is that of `eha`.
[[nodiscard]] Roundings roundings_of(const PlantDescription& plant, const Law& law);
/// A text of the law, its equation or a parameter's meaning, with the plant's reference sizes: "abs(v / 0.5 m/s)^a_v",
/// where it is written as "abs(v / 1 mm/s)^a_v".
[[nodiscard]] std::string in_sizes_of(const PlantDescription& plant, const Law& law, std::string_view text);
/// As the law is written, for `eha`.
[[nodiscard]] Roundings roundings_of(const Law& law);

/// Units of the parameters of laws that fit the plant's sites, for which it gives no size: "N/m, A"; "" for none.
[[nodiscard]] std::string missing_law_sizes(const PlantDescription& plant);

}  // namespace sealwatch
