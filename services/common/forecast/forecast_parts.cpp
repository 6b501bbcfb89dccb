#include "services/common/forecast/forecast_parts.hpp"
#include "services/common/text/numbers.hpp"

#include <algorithm>

namespace sealwatch::forecast {
namespace {

constexpr std::size_t kTestsForPresent = 3;

}  // namespace

double present_condition(const std::vector<ConditionSample>& history) {
  std::vector<double> last;
  for (std::size_t i = history.size() - std::min(kTestsForPresent, history.size()); i < history.size(); ++i)
    last.push_back(history[i].condition);
  std::sort(last.begin(), last.end());
  return last[last.size() / 2];
}

Forecast& say(Forecast& forecast, ForecastState state, std::string explanation) {
  forecast.state = state;
  forecast.explanation = std::move(explanation);
  return forecast;
}

Forecast& say_past_threshold(Forecast& forecast, const ForecastRequest& request, std::string explanation) {
  forecast.end_of_life_ns = request.now.nanoseconds;
  for (const FailureHorizon& horizon : request.horizons)
    if (horizon.before > request.now)
      forecast.failure_probability.push_back({horizon.before.nanoseconds, horizon.label, 1.0});
  return say(forecast, ForecastState::past_threshold, std::move(explanation));
}

void fill_numbers(Forecast& forecast, const ForecastRequest& request, const PredictiveDistribution& remaining) {
  forecast.rul_months = remaining.quantile(0.50);
  forecast.rul_p10_months = remaining.quantile(0.10);
  forecast.rul_p50_months = forecast.rul_months;
  forecast.rul_p90_months = remaining.quantile(0.90);
  forecast.interval_95_low_months = remaining.quantile(0.025);
  forecast.interval_95_high_months = remaining.quantile(0.975);
  forecast.end_of_life_ns = add_months(request.now, forecast.rul_months).nanoseconds;
  for (const FailureHorizon& horizon : request.horizons)
    if (horizon.before > request.now)
      forecast.failure_probability.push_back(
          {horizon.before.nanoseconds, horizon.label, remaining.cdf(months_between(request.now, horizon.before))});
}

std::string age_of_last_test(const ForecastRequest& request) {
  const double age = months_between(request.history.back().time, request.now);
  if (age <= kJitterMonths) return {};
  return "; the last usable test was " + text::in_months(age) + " ago";
}

}  // namespace sealwatch::forecast
