// Thrift where the data are rough: a law that comes to a plainer one at the end of its range.
#pragma once

#include "services/common/mismatch/naming.hpp"

namespace sealwatch::mismatch {

/// A law that comes to a plainer one at the end of its range (dry friction without a peak at standstill; Law::limit) is
/// claimed only where the plain one, sought from where the rich one ended, does worse. In a gross misfit the criterion
/// is rough, as what is left is no noise: there the rich law has to be clearly better. Puts the plain law into
/// `naming.best` otherwise, and every refit into `naming.trials`.
void prefer_plain_laws(Naming& naming, const Data& data, int threads);

/// The best trial by its criterion; of laws that these recordings cannot tell apart, one whose shape is not at the end
/// of its range, where a law is the limit of another one. Null where there is none.
[[nodiscard]] const Trial* best_of(const std::vector<Trial>& trials, double phi);

}  // namespace sealwatch::mismatch
