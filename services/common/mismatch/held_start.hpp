// Where a search sets out in a gross misfit. From values that are off by much, a free run stands still or
// drifts: what its linear model says of absent laws is then of a course that the plant never took. Held to its recorded
// states (model/held_to_recording.hpp) the simulation takes the plant's course, its parameters and laws act nearly in
// proportion, and the same search comes to what its balances lack. The free run then sets out from there, and decides.
#pragma once

#include <optional>

#include "services/common/mismatch/naming.hpp"

namespace sealwatch::mismatch {

struct HeldStart {
  std::optional<Trial> trial = {};
  bool was_cut = false;  ///< not all laws were asked
};

/// The laws that are found with the simulations held, one after the other, refitted to free runs. No law: the baseline
/// ended in a local minimum, and this is a better one. Nothing where too little of the state is measured, or where free
/// runs leave most of the misfit. `baseline`: fitted to `data`.
[[nodiscard]] HeldStart start_from_held(const FittedModel& baseline, const Data& data, const ExplainOptions& options);

}  // namespace sealwatch::mismatch
