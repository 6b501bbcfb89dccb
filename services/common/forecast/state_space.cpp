#include "sealwatch/forecast/state_space.hpp"

#include <algorithm>
#include <cmath>

#include "sealwatch/forecast/normal.hpp"
#include "services/common/forecast/forecast_parts.hpp"
#include "services/common/forecast/seal_hypotheses.hpp"
#include "services/common/text/numbers.hpp"

namespace sealwatch::forecast {
namespace {

constexpr double kSureOfFall = 0.99;  // as the one-sided 1 % of the straight lines
constexpr double kWorthSaying = 0.5;  // probability of a change that the explanation names

struct Opened {
  std::vector<DatedTest> tests;
  UtcTime first;
};

/// The tests that count, by months since the first of them.
Opened open_history(const ForecastRequest& request, int window_months) {
  Opened opened;
  const UtcTime begin = add_months(request.history.back().time, -window_months);
  for (const ConditionSample& sample : request.history) {
    if (sample.time <= begin || (request.installed && sample.time < *request.installed)) continue;
    if (opened.tests.empty()) opened.first = sample.time;
    opened.tests.push_back({months_between(opened.first, sample.time), sample.condition, sample.condition_std});
  }
  return opened;
}

SealOpinion opinion_of(const StateSpaceOptions& options, const ForecastRequest& request, const Opened& opened,
                       UtcTime when) {
  HypothesisOptions hypotheses{.population = options.population,
                               .relative_share = options.relative_share,
                               .change_per_month = options.change_per_month,
                               .age_at_first_test = std::nullopt};
  if (request.installed) hypotheses.age_at_first_test = months_between(*request.installed, opened.first);
  SealOpinion opinion = weigh_hypotheses(opened.tests, hypotheses);
  grow_old(opinion, months_between(request.history.back().time, when));
  return opinion;
}

/// Probability that theta falls from now on: of g + mu > 0.
double fall_probability(const SealOpinion& opinion) {
  double probability = 0.0;
  for (const SealHypothesis& hypothesis : opinion.hypotheses) {
    const auto& P = hypothesis.belief.covariance;
    const double variance = std::max(P[3] + 2.0 * P[4] + P[5], 1e-18);
    const double rate = hypothesis.belief.mean[1] + hypothesis.belief.mean[2];
    probability += hypothesis.weight * normal_probability(rate / std::sqrt(variance));
  }
  return probability;
}

ConditionForecast condition_of(const SealOpinion& opinion, UtcTime when) {
  double mean = 0.0;
  double square = 0.0;
  for (const SealHypothesis& hypothesis : opinion.hypotheses) mean += hypothesis.weight * hypothesis.belief.mean[0];
  for (const SealHypothesis& hypothesis : opinion.hypotheses)
    square += hypothesis.weight * (hypothesis.belief.covariance[0] + std::pow(hypothesis.belief.mean[0] - mean, 2));
  return {.time = when,
          .condition = mean,
          .condition_std = std::sqrt(std::max(square, 0.0)),
          .extra_std = opinion.extra_std};
}

const char* name_of_change(SealChange change) {
  switch (change) {
    case SealChange::rate:
      return "it has aged at another rate";
    case SealChange::level:
      return "the estimates have stood at another level";
    case SealChange::replaced:
      return "it has looked like another, new one";
    case SealChange::none:
      break;
  }
  return "";
}

/// "with 93 % probability it has aged at another rate since about 2018-03-01"; "" when none is likely.
std::string describe_change(const SealOpinion& opinion, UtcTime first) {
  for (const SealChange change : {SealChange::rate, SealChange::level, SealChange::replaced}) {
    double probability = 0.0;
    double when = 0.0;
    for (const SealHypothesis& hypothesis : opinion.hypotheses)
      if (hypothesis.change == change) {
        probability += hypothesis.weight;
        when += hypothesis.weight * hypothesis.changed_months;
      }
    if (probability > kWorthSaying)
      return "with " + text::in_percent(probability) + " probability " + name_of_change(change) + " since about " +
             format_date(add_months(first, when / probability));
  }
  return {};
}

std::string describe_ok(const Forecast& forecast, const SealOpinion& opinion, const Opened& opened,
                        const ForecastRequest& request) {
  std::string text = std::to_string(opened.tests.size());
  text += " tests up to " + format_date(request.history.back().time) + ", condition now ";
  const ConditionForecast now = condition_of(opinion, request.now);
  text += text::condition_with_std(now.condition, now.condition_std);
  const ConditionSample& last = request.history.back();
  text += last.time < request.now     ? " (carried on from then)"
          : last.condition_std == 0.0 ? " (from the scatter of the tests)"
                                      : " (by sensor noise alone)";
  double stranger = 0.0;
  for (const SealHypothesis& hypothesis : opinion.hypotheses)
    stranger += (hypothesis.kin == Kinship::stranger) * hypothesis.weight;
  if (stranger > kWorthSaying) text += "; it ages unlike the population";
  if (const std::string change = describe_change(opinion, opened.first); !change.empty()) text += "; " + change;
  if (opinion.extra_std > 0.0)
    text += "; tests scatter by " + text::spread_in_percent(opinion.extra_std) + " besides their errors";
  if (opinion.irregularity_scale > 1.0) text += "; it ages less regularly than the law says";
  if (forecast.interval_95_high_months >= kLongestMonths)
    text += "; upper limits are cut at " + text::in_months(kLongestMonths);
  return text + age_of_last_test(request);
}

}  // namespace

Status StateSpaceOptions::validate() const {
  const auto check = [](bool good, const char* place, double value, const char* rule) -> Status {
    if (good) return {};
    return fail(Error{.file = {}, .place = place, .value = text::general(value), .rule = rule, .advice = {}});
  };
  if (auto s = check(window_months >= 6 && window_months <= 600, "window_months", window_months, "must be 6 to 600");
      !s)
    return s;
  if (auto s = check(relative_share >= 0.0 && relative_share < 1.0, "relative_share", relative_share,
                     "must be at least 0, below 1");
      !s)
    return s;
  if (auto s = check(fewest_tests >= 1, "fewest_tests", fewest_tests, "must be at least 1"); !s) return s;
  if (auto s = check(change_per_month > 0.0 && change_per_month <= 0.1, "change_per_month", change_per_month,
                     "must be above 0, at most 0.1");
      !s)
    return s;
  if (auto s = check(horizon_months > 0.0 && horizon_months <= kLongestMonths, "horizon_months", horizon_months,
                     "must be above 0, at most 1200");
      !s)
    return s;
  return population.validate();
}

Result<std::unique_ptr<const Forecaster>> StateSpaceForecaster::make(const StateSpaceOptions& options) {
  if (const Status valid = options.validate(); !valid) return fail(valid.error());
  return std::unique_ptr<const Forecaster>(new StateSpaceForecaster(options));
}

PredictiveForecast StateSpaceForecaster::answer(const ForecastRequest& request) const {
  Forecast forecast;
  forecast.method = options_.method;
  forecast.window_months = options_.window_months;
  if (request.history.empty()) return {say(forecast, ForecastState::insufficient_history, "no usable test so far")};
  const Opened opened = open_history(request, options_.window_months);
  forecast.tests_used = static_cast<int>(opened.tests.size());
  if (forecast.tests_used < options_.fewest_tests) {
    if (const double present = present_condition(request.history); present <= request.threshold)
      return {say_past_threshold(forecast, request,
                                 "the condition is " + text::condition_in_percent(present) +
                                     " (median of the last tests), the limit " +
                                     text::condition_in_percent(request.threshold))};
    return {say(forecast, ForecastState::insufficient_history,
                std::to_string(forecast.tests_used) + (forecast.tests_used == 1 ? " usable test" : " usable tests") +
                    " so far, at least " + std::to_string(options_.fewest_tests) + " are needed")};
  }
  const SealOpinion opinion = opinion_of(options_, request, opened, request.now);
  std::vector<WeightedBelief> beliefs;
  for (const SealHypothesis& hypothesis : opinion.hypotheses) beliefs.push_back({hypothesis.belief, hypothesis.weight});
  Result<PredictiveDistribution> crossing =
      crossing_distribution(beliefs, opinion.law, request.threshold, kLongestMonths);
  if (!crossing) return {say(forecast, ForecastState::no_significant_trend, crossing.error().describe())};
  PredictiveDistribution& remaining = *crossing;
  const ConditionForecast now = condition_of(opinion, request.now);
  if (remaining.cdf(0.0) >= 0.5)
    return {say_past_threshold(forecast, request,
                               "the condition is " + text::condition_with_std(now.condition, now.condition_std) +
                                   ", the limit " + text::condition_in_percent(request.threshold))};
  if (const double falls = fall_probability(opinion); falls < kSureOfFall)
    return {
        say(forecast, ForecastState::no_significant_trend,
            "the condition does not fall significantly (probability that it falls: " + text::in_percent(falls) + ")")};
  if (remaining.quantile(0.5) > options_.horizon_months)
    return {say(forecast, ForecastState::no_significant_trend,
                "at this rate the end of life is more than " + text::in_months(options_.horizon_months) +
                    " away: no date is given")};
  fill_numbers(forecast, request, remaining);
  return {say(forecast, ForecastState::ok, describe_ok(forecast, opinion, opened, request)), std::move(remaining)};
}

std::vector<ConditionForecast> StateSpaceForecaster::predict_conditions(const ForecastRequest& request,
                                                                        std::span<const UtcTime> when) const {
  std::vector<ConditionForecast> conditions;
  if (request.history.empty()) return conditions;
  const Opened opened = open_history(request, options_.window_months);
  if (static_cast<int>(opened.tests.size()) < options_.fewest_tests) return conditions;
  const SealOpinion now = opinion_of(options_, request, opened, request.now);
  for (const UtcTime time : when) {
    SealOpinion then = now;
    grow_old(then, months_between(request.now, time));
    conditions.push_back(condition_of(then, time));
  }
  return conditions;
}

}  // namespace sealwatch::forecast
