// Words and numbers that go with each proposed fault.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "services/health_assessment/ambiguity.hpp"

namespace sealwatch {

/// Adds to each fault which deviations it explains, which it contradicts, and what separates it from the most likely
/// one. `faults` are sorted, most likely first.
void add_evidence(std::vector<ProposedFault>& faults, const std::vector<Deviation>& deviations,
                  const std::vector<Signature>& signatures, const std::map<std::string, SensorRemark>& remarks);

}  // namespace sealwatch
