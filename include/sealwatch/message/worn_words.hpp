// What a leakage_estimate is of, in words: of the leakage past a piston seal, or of whatever wears in another plant.
#pragma once

#include <string>

#include "sealwatch/message/prognostic_assessment.hpp"

namespace sealwatch {

/// Whether it is the leakage resistance of a piston seal. Estimates from before there were others do not say it.
[[nodiscard]] inline bool is_of_seal(const LeakageEstimate& estimate) {
  return estimate.unit.empty() || estimate.unit == "Pa s/m3";
}
/// "R_CL"
[[nodiscard]] inline std::string worn_parameter(const LeakageEstimate& estimate) {
  return estimate.parameter.empty() ? "R_CL" : estimate.parameter;
}
/// "Pa s/m3"
[[nodiscard]] inline std::string worn_unit(const LeakageEstimate& estimate) {
  return estimate.unit.empty() ? "Pa s/m3" : estimate.unit;
}
/// "seal condition"
[[nodiscard]] inline std::string worn_condition(const LeakageEstimate& estimate) {
  return is_of_seal(estimate) ? "seal condition" : "condition";
}

}  // namespace sealwatch
