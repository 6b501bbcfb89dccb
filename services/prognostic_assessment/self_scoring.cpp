#include "services/prognostic_assessment/self_scoring.hpp"

#include "sealwatch/forecast/forecast_score.hpp"

namespace sealwatch::prognostic_assessment {

void score(const forecast::Forecaster& in_charge, const forecast::ForecastRequest& request, RemainingLife& life) {
  const forecast::ScoreSummary summary =
      forecast::summarise(forecast::score_past_forecasts(in_charge, request, kScoredLead_months, kScoredForecasts));
  life.scored_forecasts = summary.forecasts;
  life.coverage_80 = summary.coverage_80;
  life.coverage_95 = summary.coverage_95;
  life.mean_crps = summary.mean_crps;
  life.confidence = summary.confidence;
}

}  // namespace sealwatch::prognostic_assessment
