// Failure modes and mechanisms of ISO 14224 (annex B) for the faults that sealwatch proposes.
#pragma once

#include <string>

#include "sealwatch/message/health_assessment.hpp"

namespace sealwatch {

struct FailureCode {
  std::string mode;       ///< failure mode of valves (actuator included): "INL"
  std::string mechanism;  ///< "1.1 Leakage"
};

[[nodiscard]] FailureCode failure_code(FaultKind kind);

}  // namespace sealwatch
