#include "sealwatch/forecast/forecast_average.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "sealwatch/forecast/forecast_score.hpp"
#include "services/common/forecast/forecast_parts.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::forecast {
namespace {

constexpr std::array<double, 3> kMonthsAgo{6.0, 12.0, 24.0};  // when the scored forecasts were made
constexpr double kReach_months = 12.0;                        // how far they are scored
constexpr double kPriorOfLaw = 7.0;                           // against 1 of each line
constexpr double kDependence = 0.5;                           // eta
constexpr double kJitter_months = 0.25;
constexpr double kFewestDensity = 1e-12;  // a miss of any size counts as this
constexpr double kMatters = 0.01;         // weights below are not worth a forecast

/// A law of ageing is believed before a line without one, until tests say otherwise.
double prior_weight(const ForecasterSettings& member) {
  return member.method == "state_space" || member.method == "fleet" ? kPriorOfLaw : 1.0;
}

/// The request as it stood at `then`.
ForecastRequest as_of(const ForecastRequest& request, UtcTime then) {
  ForecastRequest earlier{.threshold = request.threshold, .now = then, .installed = request.installed};
  for (const ConditionSample& sample : request.history)
    if (sample.time <= then) earlier.history.push_back(sample);
  return earlier;
}

/// Logarithms of the densities that the member gave to later tests; empty when it could not say anything then.
std::vector<double> log_densities(const Forecaster& member, const ForecastRequest& earlier,
                                  std::span<const ConditionSample> later) {
  std::vector<UtcTime> times;
  for (const ConditionSample& sample : later) times.push_back(sample.time);
  const std::vector<ConditionForecast> conditions = member.predict_conditions(earlier, times);
  std::vector<double> result;
  for (std::size_t k = 0; k < conditions.size(); ++k)
    result.push_back(std::log(std::max(condition_density(conditions[k], later[k]), kFewestDensity)));
  return result;
}

}  // namespace

std::vector<ForecasterSettings> AverageForecaster::default_members(const ForecasterSettings& settings) {
  std::vector<ForecasterSettings> members{{"fleet", settings.window_months},
                                          {"state_space", settings.window_months},
                                          {"ols_drift", 24},
                                          {"ols_drift", 36},
                                          {"ols_drift", 48}};
  for (ForecasterSettings& member : members) {
    member.population = settings.population;
    member.change_per_month = settings.change_per_month;
  }
  return members;
}

Result<std::unique_ptr<const Forecaster>> AverageForecaster::make(const ForecasterSettings& settings) {
  std::unique_ptr<AverageForecaster> average(new AverageForecaster);
  average->window_months_ = settings.window_months;
  average->settings_ = settings.members.empty() ? default_members(settings) : settings.members;
  for (const ForecasterSettings& member : average->settings_) {
    if (member.method == "average")
      return fail(Error{.file = {},
                        .place = "members",
                        .value = member.method,
                        .rule = "must not be an average itself",
                        .advice = {}});
    auto made = make_forecaster(member);
    if (!made) return fail(made.error());
    average->members_.push_back(std::move(*made));
  }
  return std::unique_ptr<const Forecaster>(std::move(average));
}

std::vector<double> AverageForecaster::weights(const ForecastRequest& request) const {
  std::vector<double> log_weights;
  for (const ForecasterSettings& member : settings_) log_weights.push_back(std::log(prior_weight(member)));
  if (request.history.empty()) return std::vector<double>(members_.size(), 1.0 / static_cast<double>(members_.size()));
  for (const double ago : kMonthsAgo) {
    const UtcTime then = add_months(request.history.back().time, kJitter_months - ago);
    const ForecastRequest earlier = as_of(request, then);
    std::vector<ConditionSample> later;
    for (const ConditionSample& sample : request.history)
      if (sample.time > then && sample.time <= add_months(then, kReach_months)) later.push_back(sample);
    std::vector<std::vector<double>> densities;
    std::vector<double> worst(later.size(), 0.0);
    for (const auto& member : members_) {
      densities.push_back(log_densities(*member, earlier, later));
      for (std::size_t k = 0; k < densities.back().size(); ++k) worst[k] = std::min(worst[k], densities.back()[k]);
    }
    // Who could not say anything then is judged like the worst who could.
    for (std::size_t m = 0; m < members_.size(); ++m) {
      const std::vector<double>& own = densities[m].empty() ? worst : densities[m];
      log_weights[m] += kDependence * std::accumulate(own.begin(), own.end(), 0.0);
    }
  }
  const double highest = *std::max_element(log_weights.begin(), log_weights.end());
  double sum = 0.0;
  for (double& weight : log_weights) sum += weight = std::exp(weight - highest);
  for (double& weight : log_weights) weight /= sum;
  return log_weights;
}

PredictiveForecast AverageForecaster::answer(const ForecastRequest& request) const {
  Forecast forecast;
  forecast.method = "average";
  forecast.window_months = window_months_;
  if (request.history.empty()) return {say(forecast, ForecastState::insufficient_history, "no usable test so far")};
  std::vector<double> weight = weights(request);
  std::vector<PredictiveDistribution> distributions;
  std::vector<double> shares;
  std::string names;
  std::optional<Forecast> silent;
  double silent_weight = 0.0;
  double speaking_weight = 0.0;
  for (std::size_t m = 0; m < members_.size(); ++m) {
    if (weight[m] < kMatters) continue;
    PredictiveForecast member = std::move(*members_[m]->predict(request));  // a valid request is answered
    forecast.tests_used = std::max(forecast.tests_used, member.forecast.tests_used);
    if (!member.distribution) {
      const bool has_opinion = member.forecast.state != ForecastState::insufficient_history;
      if (has_opinion) silent_weight += weight[m];
      if (!silent || has_opinion) silent = std::move(member.forecast);
      continue;
    }
    speaking_weight += weight[m];
    shares.push_back(weight[m]);
    distributions.push_back(std::move(*member.distribution));
    text::add_to_list(names, settings_[m].method + " " + std::to_string(settings_[m].window_months) + " " +
                                 text::in_percent(weight[m]));
  }
  if (silent && silent_weight >= speaking_weight) {
    if (silent->state == ForecastState::past_threshold)
      return {say_past_threshold(forecast, request, silent->explanation)};
    return {say(forecast, silent->state, silent->explanation)};
  }
  auto pooled = pool(distributions, shares);
  if (!pooled) return {say(forecast, ForecastState::insufficient_history, pooled.error().rule)};
  fill_numbers(forecast, request, *pooled);
  return {say(forecast, ForecastState::ok, "weights by past scores: " + names + age_of_last_test(request)),
          std::move(*pooled)};
}

// Mean and variance of the mixture.
std::vector<ConditionForecast> AverageForecaster::predict_conditions(const ForecastRequest& request,
                                                                     std::span<const UtcTime> when) const {
  std::vector<ConditionForecast> pooled;
  const std::vector<double> weight = weights(request);
  std::vector<double> squares(when.size(), 0.0);
  double sum = 0.0;
  for (std::size_t m = 0; m < members_.size(); ++m) {
    if (weight[m] < kMatters) continue;
    const std::vector<ConditionForecast> own = members_[m]->predict_conditions(request, when);
    if (own.empty()) continue;
    if (pooled.empty())
      for (const UtcTime time : when) pooled.push_back({.time = time});
    sum += weight[m];
    for (std::size_t k = 0; k < own.size(); ++k) {
      pooled[k].condition += weight[m] * own[k].condition;
      squares[k] += weight[m] * (std::pow(own[k].condition, 2) + condition_variance(own[k]));
      pooled[k].extra_std = std::max(pooled[k].extra_std, own[k].extra_std);
    }
  }
  for (std::size_t k = 0; k < pooled.size(); ++k) {
    pooled[k].condition /= sum;
    pooled[k].condition_std = std::sqrt(std::max(squares[k] / sum - std::pow(pooled[k].condition, 2), 0.0));
  }
  return pooled;
}

}  // namespace sealwatch::forecast
