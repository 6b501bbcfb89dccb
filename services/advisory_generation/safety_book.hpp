// Proof tests that are due, the probability of failure on demand that follows from their intervals, and what the leak
// leaves of the valve's closing (forecast/safety_margin.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sealwatch/config/configuration.hpp"
#include "sealwatch/message/advisory_generation.hpp"
#include "services/advisory_generation/assessment.hpp"

namespace sealwatch::advisory_generation {

[[nodiscard]] SafetyBook safety_book(const Evidence& evidence, const AssetConfig* asset,
                                     const std::optional<SiteSafety>& safety);

/// The cheapest option, the probability of failure on demand, what is overdue: as reasons, where they are known.
[[nodiscard]] std::vector<std::string> in_words(const std::vector<DecisionOption>& decision, const SafetyBook& book);

}  // namespace sealwatch::advisory_generation
