// Laws of one element, two of which have strengths that are uncertain by a third and more though the data clearly want
// both, nearly cancel each other: they imitate one shape that the catalogue lacks.
#pragma once

#include "services/common/mismatch/naming.hpp"

namespace sealwatch::mismatch {

/// Where the best model has such laws and no others, the best closed form that was tried at that element takes their
/// place, if it explains at least half of what they do.
void one_shape_for_several(Naming& naming, const Data& data, const ExplainOptions& options);

}  // namespace sealwatch::mismatch
