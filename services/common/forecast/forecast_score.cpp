#include "sealwatch/forecast/forecast_score.hpp"

#include <algorithm>
#include <cmath>

#include "sealwatch/forecast/normal.hpp"
#include "sealwatch/forecast/proper_scores.hpp"

namespace sealwatch::forecast {
namespace {

constexpr double kSmallestStd = 1e-6;    // rounding of histories in text files
constexpr double kLargestZ = 8.0;        // beyond, probabilities are 0 or 1 to the last digit
constexpr double kJitter_months = 0.25;  // a test that comes a week early belongs to its month

bool within(double probability, double level) { return std::abs(probability - 0.5) <= 0.5 * level; }

double z_value(double probability) {
  const double smallest = normal_probability(-kLargestZ);
  return normal_quantile(std::clamp(probability, smallest, 1.0 - 1e-15));
}

double predictive_std(const ConditionForecast& forecast, const ConditionSample& estimate) {
  const double of_estimate = std::hypot(estimate.condition_std, forecast.extra_std);
  return std::max(std::hypot(std::sqrt(condition_variance(forecast)), of_estimate), kSmallestStd);
}

}  // namespace

double condition_variance(const ConditionForecast& forecast) {
  const double nu = forecast.degrees_of_freedom;
  const double tails = nu > 2.0 ? nu / (nu - 2.0) : 1.0;
  return tails * forecast.condition_std * forecast.condition_std;
}

double condition_density(const ConditionForecast& forecast, const ConditionSample& estimate) {
  const double std = predictive_std(forecast, estimate);
  return normal_density((estimate.condition - forecast.condition) / std) / std;
}

ConditionScore score_condition(const ConditionForecast& forecast, UtcTime made, const ConditionSample& estimate) {
  ConditionScore score{.made = made,
                       .scored = estimate.time,
                       .predicted = forecast.condition,
                       .predicted_std = predictive_std(forecast, estimate),
                       .observed = estimate.condition};
  score.probability = normal_probability((estimate.condition - forecast.condition) / score.predicted_std);
  score.crps = normal_crps(forecast.condition, score.predicted_std, estimate.condition);
  score.within_80 = within(score.probability, 0.80);
  score.within_95 = within(score.probability, 0.95);
  return score;
}

ScoreSummary summarise(std::span<const ConditionScore> scores) {
  ScoreSummary summary{.forecasts = static_cast<int>(scores.size())};
  if (scores.empty()) return summary;
  double log_odds_of_drift = std::log((1.0 - kPriorConfidence) / kPriorConfidence);
  const double n = static_cast<double>(scores.size());
  for (const ConditionScore& score : scores) {
    summary.coverage_80 += score.within_80 / n;
    summary.coverage_95 += score.within_95 / n;
    summary.mean_crps += score.crps / n;
    const double z = z_value(score.probability);
    log_odds_of_drift += 0.5 * z * z * (1.0 - 1.0 / (kDriftSpread * kDriftSpread)) - std::log(kDriftSpread);
  }
  summary.confidence = 1.0 / (1.0 + std::exp(log_odds_of_drift));
  return summary;
}

std::vector<ConditionScore> score_past_forecasts(const Forecaster& forecaster, const ForecastRequest& request,
                                                 double lead_months, int count) {
  std::vector<ConditionScore> scores;
  if (request.history.empty()) return scores;
  for (int k = 0; k < count; ++k) {
    const UtcTime scored = add_months(request.history.back().time, -lead_months * k + kJitter_months);
    const UtcTime made = add_months(scored, -lead_months);
    ForecastRequest earlier{.threshold = request.threshold, .now = made, .installed = request.installed};
    const ConditionSample* estimate = nullptr;
    for (const ConditionSample& sample : request.history) {
      if (sample.time <= made) earlier.history.push_back(sample);
      if (sample.time > made && sample.time <= scored) estimate = &sample;
    }
    if (earlier.history.empty()) break;
    if (!estimate) continue;
    const auto conditions = forecaster.predict_conditions(earlier, {&estimate->time, 1});
    if (!conditions.empty()) scores.push_back(score_condition(conditions.front(), made, *estimate));
  }
  return scores;
}

}  // namespace sealwatch::forecast
