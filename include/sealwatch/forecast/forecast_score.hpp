// Self-scoring: what forecasts of the condition said about tests that have come since, and how far to trust the next.
//
//   PIT    z-value's probability, F(theta): uniform on [0, 1] when the forecasts are calibrated
//   z      standard normal value of the PIT
//
// Confidence that the forecaster still describes this seal, from the z-values of its last forecasts: the posterior
// probability of "z is standard normal" against "z has `kDriftSpread` times the spread", prior odds 9 to 1,
//
//   confidence = 1 / (1 + (1 - 0.9)/0.9 prod_k [phi(z_k / D)/D / phi(z_k)]),   D = kDriftSpread
//
// It rises slowly while forecasts come true and falls at once when they drift. Forecasts that reach over the same
// months are dependent: those that are scored should be made `lead` months apart, or the last ones count several times.
#pragma once

#include <span>
#include <vector>

#include "sealwatch/forecast/forecaster.hpp"

namespace sealwatch::forecast {

inline constexpr double kDriftSpread = 3.0;
inline constexpr double kPriorConfidence = 0.9;

/// Variance of the condition: a Student t's is wider than its scale.
[[nodiscard]] double condition_variance(const ConditionForecast& forecast);
/// Density that the forecast gives to the estimate: normal, with the variances of both added.
[[nodiscard]] double condition_density(const ConditionForecast& forecast, const ConditionSample& estimate);

/// One earlier forecast of the condition beside the estimate that came.
struct ConditionScore {
  UtcTime made;    ///< when the forecast was made
  UtcTime scored;  ///< the test that it was about
  double predicted = 0.0;
  double predicted_std = 0.0;  ///< of the estimate to come: its own standard error included
  double observed = 0.0;
  double probability = 0.0;  ///< PIT
  double crps = 0.0;         ///< of theta [1]
  bool within_80 = false;
  bool within_95 = false;
};
[[nodiscard]] ConditionScore score_condition(const ConditionForecast& forecast, UtcTime made,
                                             const ConditionSample& estimate);

struct ScoreSummary {
  int forecasts = 0;
  double coverage_80 = 0.0;  ///< share within the 80 % interval
  double coverage_95 = 0.0;
  double mean_crps = 0.0;
  double confidence = kPriorConfidence;
};
/// With nothing scored: no coverage, the prior confidence.
[[nodiscard]] ScoreSummary summarise(std::span<const ConditionScore> scores);

/// Makes again, from the history as it stood then, the forecasts of `lead_months` before each of the last `count` tests
/// that are `lead_months` apart, and scores them. A forecaster is a pure function, so these are the forecasts that were
/// given. Newest first; months in which it could not forecast are missing.
[[nodiscard]] std::vector<ConditionScore> score_past_forecasts(const Forecaster& forecaster,
                                                               const ForecastRequest& request, double lead_months,
                                                               int count);

}  // namespace sealwatch::forecast
