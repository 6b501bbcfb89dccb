// Where a term acts, in one sentence: from the share of its energy (squares over time) in each regime against the
// share of the time that the recordings spend there.
//   motion     at rest or moving, one direction or both: by the site's speed (current, flow)
//   signals    the narrowest range of speed, pressure, position, ... that holds it while it acts
//   time       first or last third of the recording
// A regime is named when it holds at least 90 % of the energy in at most 65 % of the time.
#pragma once

#include "services/common/mismatch/term_path.hpp"

namespace sealwatch::mismatch {

/// "moving, both directions; piston position above 52 mm"; "throughout" where no regime stands out. For sensors, whose
/// paths are empty, too.
[[nodiscard]] std::string regime_of(std::span<const TermPath> recordings, SiteKind kind);

/// The same of a law that a model holds, over all its recordings.
[[nodiscard]] std::string regime_of(const FittedModel& with, const std::string& element, const Law& law,
                                    std::span<const double> parameters);

}  // namespace sealwatch::mismatch
