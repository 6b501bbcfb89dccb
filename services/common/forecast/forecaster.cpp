#include "sealwatch/forecast/forecaster.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "sealwatch/core/text.hpp"
#include "sealwatch/forecast/forecast_average.hpp"
#include "sealwatch/forecast/ols.hpp"
#include "sealwatch/forecast/state_space.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch::forecast {
namespace {

// Of the lives of docs/model.md: see docs/forecast.md, "The straight lines".
constexpr const char* kStraightLine = "ols";
constexpr double kSlopeDrift = 0.20;
constexpr int kFewestTestsWithFleet = 3;  // the fleet says the rest
constexpr double kNoCondition = 1e3;      // theta is a share of one; squares of such figures drown all others

std::vector<ConditionSample> take_outliers(std::vector<ConditionSample>& history) {
  const std::vector<bool> outlier = isolated_outliers(history);
  std::vector<ConditionSample> kept;
  std::vector<ConditionSample> left_out;
  for (std::size_t i = 0; i < history.size(); ++i) (outlier[i] ? left_out : kept).push_back(history[i]);
  history = std::move(kept);
  return left_out;
}

/// Sorts, drops what was delivered twice, and takes out what is no number.
std::vector<ConditionSample> take_unusable(std::vector<ConditionSample>& history) {
  std::stable_sort(history.begin(), history.end(),
                   [](const ConditionSample& a, const ConditionSample& b) { return a.time < b.time; });
  history.erase(std::unique(history.begin(), history.end()), history.end());
  const auto unusable = std::stable_partition(history.begin(), history.end(), [](const ConditionSample& sample) {
    return std::abs(sample.condition) < kNoCondition && sample.condition_std >= 0.0 &&
           sample.condition_std < kNoCondition;
  });
  std::vector<ConditionSample> taken(unusable, history.end());
  history.erase(unusable, history.end());
  return taken;
}

std::string describe(const Forecast& forecast) {
  return "the last " + std::to_string(forecast.window_months) + " months of tests give " +
         text::in_months(forecast.rul_p50_months) +
         " left (95 %: " + text::range_in_months(forecast.interval_95_low_months, forecast.interval_95_high_months) +
         ")";
}

bool apart(const Forecast& a, const Forecast& b) {
  return a.interval_95_high_months < b.interval_95_low_months || b.interval_95_high_months < a.interval_95_low_months;
}

/// Of the straight lines in time alone: they follow the rate of ageing as it is. A line over ln t bends away from any
/// straight history, so that its windows always differ.
std::string disagreement(const std::vector<Forecast>& forecasts) {
  const Forecast* shortest = nullptr;
  const Forecast* longest = nullptr;
  for (const Forecast& forecast : forecasts) {
    if (forecast.method != kStraightLine || forecast.state != ForecastState::ok) continue;
    if (!shortest || forecast.window_months < shortest->window_months) shortest = &forecast;
    if (!longest || forecast.window_months > longest->window_months) longest = &forecast;
  }
  if (!shortest || !apart(*shortest, *longest)) return {};
  const bool faster = shortest->rul_p50_months < longest->rul_p50_months;
  return std::string(faster ? "ageing has become faster: " : "ageing has become slower: ") + describe(*shortest) +
         ", " + describe(*longest);
}

using Made = Result<std::unique_ptr<const Forecaster>>;

OlsOptions line_of(const ForecasterSettings& settings) {
  return {.method = settings.method, .window_months = settings.window_months};
}

Made make_line(const ForecasterSettings& settings) { return OlsForecaster::make(line_of(settings)); }

Made make_line_over_log_time(const ForecasterSettings& settings) {
  OlsOptions options = line_of(settings);
  options.time = DegradationTime::log_months;
  return OlsForecaster::make(options);
}

Made make_drifting_line(const ForecasterSettings& settings) {
  OlsOptions options = line_of(settings);
  options.slope_drift = kSlopeDrift;
  return OlsForecaster::make(options);
}

Made make_line_by_fieller(const ForecasterSettings& settings) {
  OlsOptions options = line_of(settings);
  options.whole_scatter = true;
  return OlsForecaster::make(options);
}

StateSpaceOptions law_of(const ForecasterSettings& settings) {
  return {.method = settings.method,
          .window_months = settings.window_months,
          .population = settings.population,
          .change_per_month = settings.change_per_month};
}

Made make_law(const ForecasterSettings& settings) { return StateSpaceForecaster::make(law_of(settings)); }

Made make_law_with_fleet(const ForecasterSettings& settings) {
  StateSpaceOptions options = law_of(settings);
  options.relative_share = 0.0;
  options.fewest_tests = kFewestTestsWithFleet;
  return StateSpaceForecaster::make(options);
}

/// All forecasters: whoever adds one adds its line here.
struct Method {
  std::string_view name;
  Made (*make)(const ForecasterSettings&);
};
constexpr std::array kMethods = {
    Method{kStraightLine, &make_line},
    Method{"ols_log_time", &make_line_over_log_time},
    Method{"ols_drift", &make_drifting_line},
    Method{"ols_fieller", &make_line_by_fieller},
    Method{"state_space", &make_law},
    Method{"fleet", &make_law_with_fleet},
    Method{"average", [](const ForecasterSettings& settings) -> Made { return AverageForecaster::make(settings); }},
};

}  // namespace

Status ForecastRequest::validate() const {
  if (threshold > 0.0 && threshold <= 1.0) return {};
  return fail(Error{.file = {},
                    .place = "threshold",
                    .value = text::general(threshold),
                    .rule = "must be above 0, at most 1",
                    .advice = "0.6 for a part that has failed at a condition of 60 %"});
}

Result<PredictiveForecast> Forecaster::predict(const ForecastRequest& request) const {
  if (const Status valid = request.validate(); !valid) return fail(valid.error());
  return answer(request);
}

Result<Forecast> Forecaster::forecast(const ForecastRequest& request) const {
  Result<PredictiveForecast> predicted = predict(request);
  if (!predicted) return fail(predicted.error());
  return std::move(predicted->forecast);
}

const std::vector<std::string>& forecast_methods() {
  static const std::vector<std::string> methods = [] {
    std::vector<std::string> names;
    for (const Method& method : kMethods) names.emplace_back(method.name);
    return names;
  }();
  return methods;
}

Result<std::unique_ptr<const Forecaster>> make_forecaster(const ForecasterSettings& settings) {
  const auto* const method = std::ranges::find(kMethods, settings.method, &Method::name);
  if (method != kMethods.end()) return method->make(settings);
  return fail(Error{.file = {},
                    .place = "forecast method",
                    .value = settings.method,
                    .rule = "is not known",
                    .advice = suggest(settings.method, forecast_methods())});
}

std::vector<ForecasterSettings> default_forecasters() {
  return {{"state_space", kWholeLife_months},
          {"ols", 36},
          {"ols", 24},
          {"ols", 48},
          {"ols_drift", 36},
          {"ols_log_time", 36},
          {"fleet", kWholeLife_months},
          {"average", kWholeLife_months}};
}

Result<ForecastPanel> ForecastPanel::make(const std::vector<ForecasterSettings>& settings) {
  if (settings.empty()) return fail("at least one forecaster is needed");
  ForecastPanel panel;
  for (const ForecasterSettings& one : settings) {
    auto forecaster = make_forecaster(one);
    if (!forecaster) return fail(forecaster.error());
    panel.forecasters_.push_back(std::move(*forecaster));
  }
  return panel;
}

Result<ForecastPanel::Answer> ForecastPanel::forecast(ForecastRequest request) const {
  if (const Status valid = request.validate(); !valid) return fail(valid.error());
  Answer answer;
  answer.left_out = take_unusable(request.history);
  for (const ConditionSample& outlier : take_outliers(request.history)) answer.left_out.push_back(outlier);
  for (const auto& forecaster : forecasters_) {
    Result<PredictiveForecast> predicted = forecaster->predict(request);
    if (!predicted) return fail(predicted.error());
    answer.forecasts.push_back(std::move(predicted->forecast));
    answer.distributions.push_back(std::move(predicted->distribution));
  }
  answer.used = std::move(request.history);
  answer.disagreement = disagreement(answer.forecasts);
  answer.windows_disagree = !answer.disagreement.empty();
  return answer;
}

}  // namespace sealwatch::forecast
