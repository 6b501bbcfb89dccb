// Thrift where the data are rough: a law that comes to a plainer one at the end of its range.
#pragma once

#include "services/common/mismatch/naming.hpp"

namespace sealwatch::mismatch {

/// In a gross misfit the criterion is rough, as what is left is no noise: a law that comes to a plainer one at the end
/// of its range (bristles that bend by micrometres: plain dry friction; Law::limit) is claimed only where it is clearly
/// better. Puts the plain law into `naming.best` otherwise, and every refit into `naming.trials`.
void prefer_plain_laws(Naming& naming, const Data& data, int threads);

/// The best trial by its criterion; of laws that these recordings cannot tell apart, one whose shape is not at the end
/// of its range, where a law is the limit of another one. Null where there is none.
[[nodiscard]] const Trial* best_of(const std::vector<Trial>& trials, double phi);

}  // namespace sealwatch::mismatch
