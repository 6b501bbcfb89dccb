// Closed forms at the sites of a plant's own kind, of which the catalogue knows nothing: curves of the signals that laws
// see there, with free exponents and widths.
//
//   power        k sgn(s) |s / S|^a                 resistance, spring, friction
//   even power   k |s / S|^b                        what does not change sign with s
//   saturation   k tanh(s / w)                      friction of constant size, slack, a limit
//   product      k (s / S) |r / R|^b                what one signal does, more or less of it by another
//
// s, r: signals; S, R: their usual sizes, as the plant's file gives them; k: in the site's unit, of any sign; a, b: numbers;
// w: in the unit of s. Corners are rounded as those of the catalogue's closed forms are (model/laws/power_law.hpp).
#pragma once

#include <vector>

#include "services/common/equations/text_plant.hpp"

namespace sealwatch::equations {

/// Those of all sites whose size and whose signals' sizes are given. They bear the id `unlisted`.
[[nodiscard]] std::vector<Law> curves_at_sites(const TextPlant& plant, const Faults& faults);

/// Whether curves are asked there.
[[nodiscard]] bool has_curves(const TextSite& site);

}  // namespace sealwatch::equations
