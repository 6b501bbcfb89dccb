// What is kept of one simulated life: the estimates beside the truth, and every forecaster's answer at each test beside
// the remaining life that was true then. Everything that is reported follows from these records.
//
// A record is a compact file of its own (little-endian, checked by a sum at its end): runs resume life by life, and
// shards of one run are put together by collecting their files.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sealwatch/core/result.hpp"
#include "sealwatch/message/prognostic_assessment.hpp"

namespace sealwatch::verification {

/// One test before the end of life.
struct RecordedTest {
  double time_months = 0.0;  ///< since installation
  double condition = 0.0;    ///< theta, true
  bool usable = false;       ///< the estimate may take part in forecasts
  double estimate = 0.0;     ///< of theta
  double estimate_std = 0.0;
  friend bool operator==(const RecordedTest&, const RecordedTest&) = default;
};

inline constexpr double kAlphaLambdaAlpha = 0.2;  ///< share of the true remaining life that a forecast may be off

/// One forecaster's answer at one test. Months; numbers only in state ok, and all zero in past_threshold.
struct RecordedAnswer {
  ForecastState state = ForecastState::insufficient_history;
  float rul = 0.0F;
  float interval_95_low = 0.0F, interval_95_high = 0.0F;
  float p10 = 0.0F, p90 = 0.0F;
  float pit = 0.0F;   ///< F(true remaining life), F the predictive distribution; 1 in past_threshold
  float crps = 0.0F;  ///< of F at the true remaining life
  /// F((1 + alpha) r*) - F((1 - alpha) r*), r* the true remaining life, alpha kAlphaLambdaAlpha; 0 in past_threshold.
  float mass_within_alpha = 0.0F;
  friend bool operator==(const RecordedAnswer&, const RecordedAnswer&) = default;
};

struct LifeRecord {
  std::uint32_t life = 0;  ///< number within the run, from 0
  double end_of_life_months = 0.0;
  bool censored = false;                             ///< the end of life comes after the months of service
  std::vector<RecordedTest> tests;                   ///< from where the scenario is scored
  std::vector<std::vector<RecordedAnswer>> answers;  ///< of each method, one for each test
  [[nodiscard]] double true_rul_months(std::size_t test) const { return end_of_life_months - tests[test].time_months; }
  friend bool operator==(const LifeRecord&, const LifeRecord&) = default;
};

[[nodiscard]] std::string to_bytes(const LifeRecord& record);
/// An Error for anything but what to_bytes made.
[[nodiscard]] Result<LifeRecord> life_from_bytes(std::string_view bytes);

}  // namespace sealwatch::verification
