// From what is in force to one recommendation: the most urgent call for work, in words for the operator on shift.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sealwatch/message/advisory_generation.hpp"
#include "services/advisory_generation/assessment.hpp"

namespace sealwatch::advisory_generation {

inline constexpr const char* kPistonSeal = "piston seal";

struct Recommendation {
  AdvisoryPriority priority = AdvisoryPriority::information;
  AdvisoryAction action = AdvisoryAction::none;
  std::string text;                    ///< one or two sentences
  std::optional<UtcTime> latest_by;    ///< when the action must have been taken
  std::optional<UtcTime> work_before;  ///< when the seal must have been replaced
  std::vector<std::string> also;       ///< less urgent calls, as reasons
};

/// `part`: what wears, and is replaced; "" where nothing does.
[[nodiscard]] Recommendation recommend(const Evidence& evidence, const Assessment& assessment, const InForce& in_force,
                                       const SiteConfig* site, const std::string& part = kPistonSeal);

/// Why the dates are what they are: the time to book a vessel; that the date in force is held where this test alone
/// names another. Nothing where the recommendation names no date.
[[nodiscard]] std::vector<std::string> reasons_of_dates(const Recommendation& recommendation,
                                                        const TestVerdict& verdict, const InForce& in_force,
                                                        const SiteConfig* site, const Options& options);

/// Whether the action is work on the actuator, for which a work order is made.
[[nodiscard]] bool is_replacement(AdvisoryAction action);

}  // namespace sealwatch::advisory_generation
