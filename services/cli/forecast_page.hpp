// What `sealwatch forecast --page` writes: history, forecast, decision and reasons as one self-contained HTML page.
#pragma once

#include <string>
#include <vector>

#include "services/cli/forecast_question.hpp"

namespace sealwatch::cli {

/// What the page says of one asset. No clock in it: the same history and options give the same page.
[[nodiscard]] Result<std::string> forecast_body(const ForecastQuestion& question,
                                                const forecast::ForecastPanel::Answer& answer,
                                                const std::vector<DecisionOption>& decision);

/// Writes the page around it.
[[nodiscard]] Status write_forecast_page(const std::string& file, const Result<std::string>& body);

/// Answers the questions, one for each asset, and writes one page of all.
[[nodiscard]] Status write_forecasts(const std::string& file, const std::vector<ForecastQuestion>& questions);

}  // namespace sealwatch::cli
