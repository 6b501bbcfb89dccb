#include "sealwatch/forecast/ols.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "sealwatch/forecast/degradation_line.hpp"
#include "services/common/forecast/forecast_parts.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/readable.hpp"

namespace sealwatch::forecast {
namespace {

constexpr int kFewestTests = 6;  // below, Student's t is so wide that no interval helps anybody

/// Months since the seal was new <-> the time that the line is straight in.
struct TimeAxis {
  DegradationTime kind;
  UtcTime installed;
  double now_months;  ///< since installed
  [[nodiscard]] double months(UtcTime time) const { return months_between(installed, time); }
  [[nodiscard]] double y(double months) const { return kind == DegradationTime::months ? months : std::log(months); }
  [[nodiscard]] double remaining_months(double y) const {
    const double end = kind == DegradationTime::months ? y : std::exp(std::min(y, std::log(1e6)));
    return std::clamp(end - now_months, 0.0, kLongestMonths);
  }
};

TimeAxis time_axis(DegradationTime kind, const ForecastRequest& request) {
  const UtcTime installed = request.installed.value_or(add_months(request.history.front().time, -1.0));
  return {.kind = kind, .installed = installed, .now_months = months_between(installed, request.now)};
}

std::vector<ConditionSample> last_months(const std::vector<ConditionSample>& history, int window_months) {
  const UtcTime begin = add_months(history.back().time, -window_months);
  std::vector<ConditionSample> window;
  for (const ConditionSample& sample : history)
    if (sample.time > begin) window.push_back(sample);
  return window;
}

/// "" when the window is filled well enough.
std::string missing_history(const OlsOptions& options, const ForecastRequest& request, std::size_t tests) {
  const double reach = months_between(request.history.front().time, request.history.back().time);
  if (reach < options.window_months - kJitterMonths)
    return "history reaches back " + text::in_months(reach) + " of the " + std::to_string(options.window_months) +
           " of this window (" + std::to_string(tests) + " usable " + (tests == 1 ? "test" : "tests") + " so far)";
  const int fewest =
      std::max(kFewestTests, static_cast<int>(std::ceil(options.fewest_tests_share * options.window_months)));
  if (static_cast<int>(tests) < fewest)
    return std::to_string(tests) + " usable tests in the last " + std::to_string(options.window_months) +
           " months, at least " + std::to_string(fewest) + " are needed";
  return {};
}

std::optional<DegradationLine> fit(const OlsOptions& options, const TimeAxis& axis,
                                   const std::vector<ConditionSample>& window) {
  std::vector<LinePoint> points;
  for (const ConditionSample& sample : window)
    if (axis.months(sample.time) > 0.0)
      points.push_back({axis.y(axis.months(sample.time)), sample.condition, sample.condition_std});
  auto line = fit_degradation_line(points, options.slope_drift, axis.y(axis.now_months));
  if (line && options.whole_scatter) line->irregularity_variance = line->scatter_variance;
  return line;
}

/// Months left with the probability that the end comes before them. Beyond the highest level that exists nothing is
/// said.
constexpr std::array<double, 29> kLevels{0.001, 0.005, 0.01, 0.025, 0.05, 0.075, 0.10,  0.15,  0.20, 0.25,
                                         0.30,  0.35,  0.40, 0.45,  0.50, 0.55,  0.60,  0.65,  0.70, 0.75,
                                         0.80,  0.85,  0.90, 0.925, 0.95, 0.975, 0.990, 0.995, 0.999};

/// None when a level up to 97.5 % does not exist.
std::optional<PredictiveDistribution> crossing_distribution(const DegradationLine& line, double threshold,
                                                            const TimeAxis& axis) {
  std::vector<PredictiveDistribution::Point> points;
  points.reserve(kLevels.size() + 1);
  for (const double level : kLevels) {
    const auto y = line.crossing_quantile(threshold, level);
    if (!y && level <= 0.975) return std::nullopt;
    if (!y) {
      points.push_back({kLongestMonths, points.back().probability});
      break;
    }
    points.push_back({axis.remaining_months(*y), level});
  }
  auto distribution = PredictiveDistribution::make(std::move(points));
  assert(distribution);
  return std::move(*distribution);
}

/// Of the line itself: exact where the table of the distribution interpolates.
void fill_failure_probabilities(Forecast& forecast, const ForecastRequest& request, const DegradationLine& line,
                                const TimeAxis& axis) {
  for (FailureProbability& item : forecast.failure_probability)
    item.probability = line.crossing_probability(request.threshold, axis.y(axis.months({item.before_ns})));
}

std::string describe_ok(const Forecast& forecast, const ForecastRequest& request, const DegradationLine& line) {
  std::string text = std::to_string(forecast.tests_used) + " tests that scatter by " +
                     text::spread_in_percent(std::sqrt(line.scatter_variance)) + " about the line";
  text += age_of_last_test(request);
  if (forecast.interval_95_high_months >= kLongestMonths)
    text += "; upper limits are cut at " + text::in_months(kLongestMonths);
  return text;
}

}  // namespace

Status OlsOptions::validate() const {
  const auto check = [](bool good, const char* place, double value, const char* rule) -> Status {
    if (good) return {};
    return fail(Error{.file = {}, .place = place, .value = text::general(value), .rule = rule, .advice = {}});
  };
  if (auto s = check(window_months >= 6 && window_months <= 240, "window_months", window_months, "must be 6 to 240");
      !s)
    return s;
  if (auto s = check(slope_drift >= 0.0 && slope_drift <= 0.25, "slope_drift", slope_drift, "must be 0 to 0.25"); !s)
    return s;
  if (auto s = check(significance > 0.0 && significance <= 0.01, "significance", significance,
                     "must be above 0, at most 0.01");
      !s)
    return s;
  if (auto s = check(fewest_tests_share > 0.0 && fewest_tests_share <= 1.0, "fewest_tests_share", fewest_tests_share,
                     "must be above 0, at most 1");
      !s)
    return s;
  return check(horizon_months > 0.0 && horizon_months <= kLongestMonths, "horizon_months", horizon_months,
               "must be above 0, at most 1200");
}

Result<std::unique_ptr<const Forecaster>> OlsForecaster::make(const OlsOptions& options) {
  if (const Status valid = options.validate(); !valid) return fail(valid.error());
  return std::unique_ptr<const Forecaster>(new OlsForecaster(options));
}

PredictiveForecast OlsForecaster::answer(const ForecastRequest& request) const {
  Forecast forecast;
  forecast.method = options_.method;
  forecast.window_months = options_.window_months;
  if (request.history.empty()) return {say(forecast, ForecastState::insufficient_history, "no usable test so far")};

  const std::vector<ConditionSample> window = last_months(request.history, options_.window_months);
  forecast.tests_used = static_cast<int>(window.size());
  const double present = present_condition(request.history);
  if (present <= request.threshold)
    return {say_past_threshold(forecast, request,
                               "the condition is " + text::condition_in_percent(present) +
                                   " (median of the last tests), the limit " +
                                   text::condition_in_percent(request.threshold))};
  if (const std::string missing = missing_history(options_, request, window.size()); !missing.empty())
    return {say(forecast, ForecastState::insufficient_history, missing)};

  const TimeAxis axis = time_axis(options_.time, request);
  const auto line = fit(options_, axis, window);
  if (!line) return {say(forecast, ForecastState::insufficient_history, "fewer than three tests since it was new")};
  const double p = line->no_fall_probability();
  auto remaining = crossing_distribution(*line, request.threshold, axis);
  if (p > options_.significance)
    return {say(forecast, ForecastState::no_significant_trend,
                "the condition does not fall significantly over these months (p = " + text::in_sentence(p, 2) + ")")};
  if (!remaining)
    return {say(forecast, ForecastState::no_significant_trend,
                "the condition falls (p = " + text::in_sentence(p, 2) +
                    "), but this line may never reach the limit: no date is given")};
  if (remaining->quantile(0.5) <= 0.0)
    return {say_past_threshold(forecast, request,
                               "the fitted line is at " +
                                   text::condition_in_percent(line->condition_at(axis.y(axis.now_months))) +
                                   " now, the limit is " + text::condition_in_percent(request.threshold))};
  if (remaining->quantile(0.5) > options_.horizon_months)
    return {say(forecast, ForecastState::no_significant_trend,
                "at this rate the end of life is more than " + text::in_months(options_.horizon_months) +
                    " away: no date is given")};
  fill_numbers(forecast, request, *remaining);
  fill_failure_probabilities(forecast, request, *line, axis);
  return {say(forecast, ForecastState::ok, describe_ok(forecast, request, *line)), std::move(remaining)};
}

std::vector<ConditionForecast> OlsForecaster::predict_conditions(const ForecastRequest& request,
                                                                 std::span<const UtcTime> when) const {
  std::vector<ConditionForecast> conditions;
  if (request.history.empty()) return conditions;
  const std::vector<ConditionSample> window = last_months(request.history, options_.window_months);
  if (!missing_history(options_, request, window.size()).empty()) return conditions;
  const TimeAxis axis = time_axis(options_.time, request);
  const auto line = fit(options_, axis, window);
  if (!line) return conditions;
  for (const UtcTime time : when) {
    const double y = axis.y(axis.months(time));
    conditions.push_back({.time = time,
                          .condition = line->condition_at(y),
                          .condition_std = line->prediction_std(y),
                          .degrees_of_freedom = line->degrees_of_freedom()});
  }
  return conditions;
}

}  // namespace sealwatch::forecast
