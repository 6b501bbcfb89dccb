// Failure modes and mechanisms of ISO 14224:2016 (annex B) for the faults that sealwatch proposes. INL is spelled out as
// "internal leakage utility medium" in the SINTEF PDS Data Handbook (2021 edition, list of abbreviations); the tables of
// the standard itself were not at hand.
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
