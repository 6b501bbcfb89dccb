// Words and numbers that go with each proposed fault.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "services/health_assessment/ambiguity.hpp"

namespace sealwatch {

/// A proposed fault and the one of its signatures that explains most.
struct Proposal {
  ProposedFault fault;
  Signature signature;
};

/// Adds to each fault which deviations it would explain and what separates it from the most likely one. `proposals` are
/// sorted, most likely first.
void add_evidence(std::vector<Proposal>& proposals, const std::vector<Deviation>& deviations,
                  const std::map<std::string, SensorRemark>& remarks);

}  // namespace sealwatch
