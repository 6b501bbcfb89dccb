// What all forecasters share: how a forecast is said.
#pragma once

#include <string>
#include <vector>

#include "sealwatch/forecast/forecaster.hpp"

namespace sealwatch::forecast {

inline constexpr double kLongestMonths = 1200.0;  ///< upper quantiles are cut here: a hundred years, still a date
inline constexpr double kJitterMonths =
    1.5;  ///< m monthly tests span m - 1 months, and each comes up to half a month off

/// Median of the last three tests.
[[nodiscard]] double present_condition(const std::vector<ConditionSample>& history);

Forecast& say(Forecast& forecast, ForecastState state, std::string explanation);
Forecast& say_past_threshold(Forecast& forecast, const ForecastRequest& request, std::string explanation);

/// Numbers of a forecast that is ok; failure probabilities included.
void fill_numbers(Forecast& forecast, const ForecastRequest& request, const PredictiveDistribution& remaining);

/// "; the last usable test was 5 months ago", "" when it was not long ago.
[[nodiscard]] std::string age_of_last_test(const ForecastRequest& request);

}  // namespace sealwatch::forecast
