// Forecasts, failure probabilities and the decision between campaigns for the terminal.
#pragma once

#include <string>
#include <vector>

#include "sealwatch/message/prognostic_assessment.hpp"

namespace sealwatch::cli {

/// Forecasts side by side, with intervals; below them the probability of failure before each date, as figure and bar.
[[nodiscard]] std::string forecast_table(const std::vector<Forecast>& forecasts);

/// How the forecasts of three months before came true, with a verdict where the figures bear one. "" before any is
/// scored.
[[nodiscard]] std::string scored_line(const RemainingLife& life);

/// The choice between going now, each campaign and waiting: probability of failure before it, out of 1, and expected
/// cost, out of the dearest, as figures and bars; the cheapest is marked. "" where the site gives no costs: the
/// probabilities stand below the forecasts already.
[[nodiscard]] std::string decision_chart(const std::vector<DecisionOption>& decision);

}  // namespace sealwatch::cli
