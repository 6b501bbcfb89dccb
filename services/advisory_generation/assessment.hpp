// What the messages of one test say to the one who plans the work: the decision table of docs/advisories.md.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/message/advisory_generation.hpp"
#include "sealwatch/message/health_assessment.hpp"
#include "sealwatch/message/prognostic_assessment.hpp"
#include "sealwatch/message/state_detection.hpp"
#include "services/advisory_generation/options.hpp"
#include "services/advisory_generation/verdicts.hpp"

namespace sealwatch::advisory_generation {

/// What a test said of itself when it came.
struct TestWords {
  std::vector<std::string> reasons = {};  ///< its condition, and why it was left out where it was
  SafetyBook margins = {};
};

/// All that is known of one test.
struct Evidence {
  RemainingLife life;
  HealthReport health;
  StateReport state;
  LeakageEstimate leakage;
  /// After a retraction nobody sends the estimate of the test that is the last now: what it said then. Without it the
  /// estimate tells.
  std::optional<TestWords> said = {};
};

struct Assessment {
  TestVerdict verdict;
  std::string repeat_reason;         ///< "" when the test need not be repeated
  std::string alarm_reason;          ///< "" when no alarm has its cause in the actuator
  std::string model_alarm;           ///< channels whose residuals are in alarm
  std::string instruments_reason;    ///< "" when they are trusted
  std::vector<std::string> reasons;  ///< with numbers, units and dates
};

/// `site` may be null (no campaigns known, the default booking lead time).
[[nodiscard]] Assessment assess(const Evidence& evidence, const SiteConfig* site, const Options& options);

/// 00:00 UTC of the day of `time`: dates of work are whole days.
[[nodiscard]] UtcTime start_of_day(UtcTime time);

/// How long before the work a vessel must be booked.
[[nodiscard]] double booking_lead_time_months(const SiteConfig* site);

}  // namespace sealwatch::advisory_generation
