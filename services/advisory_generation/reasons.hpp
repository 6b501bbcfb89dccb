// Reasons in words, with numbers, units and dates.
#pragma once

#include <string>
#include <vector>

#include "sealwatch/message/health_assessment.hpp"
#include "sealwatch/message/prognostic_assessment.hpp"

namespace sealwatch::advisory_generation {

struct Evidence;

/// Forecast, failure probabilities, seal condition, health, alert regions, verdict of the test; in this order.
[[nodiscard]] std::vector<std::string> reasons_of(const Evidence& evidence);

/// Those of an advice that tell of the condition that the test of this header measured.
[[nodiscard]] std::vector<std::string> reasons_of_condition(const Header& test,
                                                            const std::vector<std::string>& reasons);

/// " (limit 60.0 %)", or nothing where the message knows of none.
[[nodiscard]] std::string limit_of(const RemainingLife& life);

/// "internal leakage of piston seal, likelihood 81 % (ISO 14224 INL)"
[[nodiscard]] std::string describe(const ProposedFault& fault);

}  // namespace sealwatch::advisory_generation
