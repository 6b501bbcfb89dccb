// Whether a small law beside a large one is more than what the large one's form may be off by. No law has a plant's exact
// form, and what its form lacks asks for other laws.
//
//   F: all laws and closed forms at the large law's element, at all points of their grids, of either sign: close to a free
//      curve of the signals there
//   d_F = g_F' G_F^-1 g_F     what they take off the misfit together, linearised (screening.hpp)
//   d_FS, d_S                 with the small law S beside them; of that law alone
//   more than form:           d_FS - d_F > worth of another law, and > d_S / 2
//
// At the model without the small law, near the noise: there the linear model holds.
#pragma once

#include <vector>

#include "sealwatch/mismatch/explain.hpp"
#include "services/common/mismatch/refits.hpp"

namespace sealwatch::mismatch {

/// Those of the small laws, each with its parameters, that are more. `without`: the model with the large law and without
/// them. None at the same element, where each law could be a form of the other.
[[nodiscard]] std::vector<LawStart> more_than_form(const FittedModel& without, const Effect& large,
                                                   std::vector<LawStart> small, const Data& data,
                                                   const ExplainOptions& options);

}  // namespace sealwatch::mismatch
