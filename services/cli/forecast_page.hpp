// What `sealwatch forecast --page` writes: history, forecast, decision and reasons as one self-contained HTML page.
#pragma once

#include <string>
#include <vector>

#include "services/cli/forecast_question.hpp"

namespace sealwatch::cli {

/// No clock in it: the same history and options give the same page.
[[nodiscard]] Result<std::string> forecast_page(const ForecastQuestion& question,
                                                const forecast::ForecastPanel::Answer& answer,
                                                const std::vector<DecisionOption>& decision);

}  // namespace sealwatch::cli
