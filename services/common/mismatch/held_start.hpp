// Where a search sets out in a simulation that is far off. From values that are off by much, a free run stands still or
// drifts: what its linear model says of absent laws is then of a course that the plant never took. Held to its recorded
// states (model/held_to_recording.hpp) the simulation takes the plant's course, its parameters and laws act nearly in
// proportion, and the same search comes to what its balances lack. The free run then sets out from there, and decides.
#pragma once

#include <optional>

#include "services/common/mismatch/naming.hpp"

namespace sealwatch::mismatch {

/// Whether a channel is missed by more than a tenth of its own course.
[[nodiscard]] bool is_far_off(const FittedModel& model);

/// The laws that are found with the simulations held, one after the other, refitted to free runs; nothing where there are
/// none, or where free runs are no better with them. `baseline`: fitted to `data`.
[[nodiscard]] std::optional<Trial> start_from_held(const FittedModel& baseline, const Data& data,
                                                   const ExplainOptions& options);

}  // namespace sealwatch::mismatch
