// Self-scoring in service: what the primary forecaster said a quarter of a year before each of the last tests,
// against what they gave (forecast/forecast_score.hpp).
#pragma once

#include "sealwatch/forecast/forecaster.hpp"
#include "sealwatch/message/prognostic_assessment.hpp"

namespace sealwatch::prognostic_assessment {

/// A quarter of a year ahead: far enough for a wrong rate to show against the estimates' own scatter.
inline constexpr double kScoredLead_months = 3.0;
/// Two years of them: what was wrong earlier was another phase of ageing.
inline constexpr int kScoredForecasts = 8;

/// Fills in scored_forecasts, coverages, CRPS and confidence. `request.history` holds what was used, outliers left out.
void score(const forecast::Forecaster& in_charge, const forecast::ForecastRequest& request, RemainingLife& life);

}  // namespace sealwatch::prognostic_assessment
