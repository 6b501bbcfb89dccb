// The part of the forecast's page that weighs dates: table and curves over the date of the replacement.
#pragma once

#include <string>
#include <vector>

#include "services/cli/forecast_question.hpp"

namespace sealwatch::cli {

/// 2021.25 for the beginning of April 2021.
[[nodiscard]] double calendar_year(UtcTime time);

[[nodiscard]] std::string forecast_decision_part(const ForecastQuestion& question,
                                                 const forecast::ForecastPanel::Answer& answer,
                                                 const std::vector<DecisionOption>& decision);

}  // namespace sealwatch::cli
