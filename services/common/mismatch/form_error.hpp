// Whether a small law beside large ones is more than what the large ones' forms may be off by. No law has a plant's exact
// form, and what its form lacks asks for other laws.
//
//   F: all laws and closed forms at the large laws' elements, at all points of their grids, of either sign: close to free
//      curves of the signals there. Other forms of the small law itself are none of them.
//   d_F = g_F' G_F^-1 g_F     what they take off the misfit together, linearised (screening.hpp)
//   d_FS, d_S                 with the small law S beside them; of that law alone
//   more than form:           d_FS - d_F > worth of another law, and > d_S / 2
//
// At the model without the small law, near the noise: there the linear model holds.
#pragma once

#include <span>
#include <vector>

#include "sealwatch/mismatch/explain.hpp"
#include "services/common/mismatch/refits.hpp"

namespace sealwatch::mismatch {

/// Those of the small laws, each with its parameters, that are more. `without`: the model with the large laws and without
/// them.
[[nodiscard]] std::vector<LawStart> more_than_form(const FittedModel& without, std::span<const Effect> large,
                                                   std::vector<LawStart> small, const Data& data,
                                                   const ExplainOptions& options);

}  // namespace sealwatch::mismatch
