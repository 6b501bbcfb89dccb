// Two laws of one element whose strengths are each uncertain by a third and more, though the data clearly want both,
// nearly cancel each other: they imitate one shape that the catalogue lacks.
#pragma once

#include "services/common/mismatch/naming.hpp"

namespace sealwatch::mismatch {

/// Where the best model is such a pair, the best closed form that was tried at that element takes its place, if it
/// explains at least half of what the pair does.
void one_shape_for_two_laws(Naming& naming, const Data& data, const ExplainOptions& options);

}  // namespace sealwatch::mismatch
