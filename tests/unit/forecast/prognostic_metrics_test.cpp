// Metrics by hand-computed lives, among them those that reference implementations are known to get wrong.
#include "sealwatch/forecast/prognostic_metrics.hpp"

#include <gmock/gmock.h>

#include <cmath>

namespace sealwatch::forecast {
namespace {

constexpr double kRounding = 1e-12;

/// A life that ends at `end` with these errors at months first, first + step, ...
std::vector<ScoredMonth> life(double end, double first, double step, const std::vector<std::optional<double>>& errors) {
  std::vector<ScoredMonth> months;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double t = first + step * static_cast<double>(i);
    ScoredMonth month{.time_months = t, .true_rul_months = end - t, .rul_months = std::nullopt};
    if (errors[i]) month.rul_months = month.true_rul_months + *errors[i];
    months.push_back(month);
  }
  return months;
}

// End of life 120, predicted 132 at t = 84 .. 114: of the date, one would get 1 - 12/120 = 0.90 at every month.
TEST(Saxena, RelativeAccuracyIsOfTheRemainingLifeNotOfTheDate) {
  const auto months = life(120.0, 84.0, 6.0, {12.0, 12.0, 12.0, 12.0, 12.0, 12.0});
  EXPECT_NEAR(*cumulative_relative_accuracy(months), 0.18, 0.005);
  EXPECT_NEAR(*relative_accuracy(months.front()), 1.0 - 12.0 / 36.0, kRounding);
  EXPECT_NEAR(*relative_accuracy(months.back()), -1.0, kRounding);
}

// Within 5 % of 100 months at t = 50, then not, then from t = 80 on to the end.
TEST(Saxena, HorizonOfAFirstHitThatDoesNotLast) {
  const auto months = life(100.0, 50.0, 10.0, {4.0, 20.0, 20.0, 5.0, -3.0});
  const PrognosticHorizon horizon = prognostic_horizon(months, 0.05);
  EXPECT_EQ(horizon.first, 50.0);
  EXPECT_EQ(horizon.stable, 20.0);
  EXPECT_EQ(prognostic_horizon(life(100.0, 50.0, 10.0, {4.0, 20.0}), 0.05).stable, std::nullopt);
  EXPECT_EQ(prognostic_horizon({}, 0.05).first, std::nullopt);
}

TEST(Saxena, HorizonNeedsANumberInEveryMonth) {
  const auto months = life(100.0, 50.0, 10.0, {0.0, std::nullopt, 0.0});
  EXPECT_EQ(prognostic_horizon(months, 0.05).stable, 30.0);
}

// A constant error of 6 from t = 60 to 120: the area's centroid is at (90, 3), the distance from (60, 0) is
// hypot(30, 3). From the origin of time, or with the error's mean instead of half of it, it would be another.
TEST(Saxena, ConvergenceIsTheDistanceOfTheCentroidFromTheFirstForecast) {
  const auto months = life(121.0, 60.0, 10.0, {6.0, -6.0, 6.0, 6.0, -6.0, 6.0, 6.0});
  EXPECT_NEAR(*convergence_distance(months), std::hypot(30.0, 3.0), kRounding);
  const auto early = life(121.0, 60.0, 10.0, {12.0, 6.0, 3.0, 1.0, 0.5, 0.2, 0.1});
  const auto late = life(121.0, 60.0, 10.0, {12.0, 12.0, 12.0, 12.0, 6.0, 3.0, 1.0});
  EXPECT_LT(*convergence_distance(early), *convergence_distance(late));
  EXPECT_EQ(*convergence_distance(life(121.0, 60.0, 10.0, {0.0, 0.0})), 0.0);
  EXPECT_FALSE(convergence_distance(life(121.0, 60.0, 10.0, {3.0})));
}

// t_P = 40 (the first number), half of the way to 100 is 70: 30 months left, error 8 is within 30 %, not within 20 %.
TEST(Saxena, AlphaLambdaIsJudgedOnTheWayFromTheFirstNumber) {
  const auto months = life(100.0, 30.0, 10.0, {std::nullopt, 50.0, 40.0, 30.0, 8.0, 5.0, 5.0});
  EXPECT_EQ(alpha_lambda_accuracy(months, 0.3, 0.5), true);
  EXPECT_EQ(alpha_lambda_accuracy(months, 0.2, 0.5), false);
  EXPECT_EQ(alpha_lambda_accuracy(months, 0.3, 0.0), false);
  EXPECT_EQ(alpha_lambda_accuracy(life(100.0, 30.0, 10.0, {std::nullopt}), 0.3, 0.5), std::nullopt);
}

/// One month with 30 months left, whose forecast is this distribution.
PredictedMonth predicted(std::vector<PredictiveDistribution::Point> points, double true_rul_months = 30.0) {
  PredictedMonth month{.scored = {.time_months = 70.0, .true_rul_months = true_rul_months, .rul_months = {}},
                       .distribution = PredictiveDistribution::make(std::move(points)).value()};
  month.scored.rul_months = month.distribution->quantile(0.5);
  return month;
}

// Uniform on 20 .. 40 months: 24 .. 36 holds 12 of 20. Uniform on 20 .. 24 and 36 .. 40: nothing, though the interval
// between the two halves has its median.
TEST(Saxena, ProbabilityWithinIsTheShareOfTheDistribution) {
  EXPECT_NEAR(probability_within(predicted({{20.0, 0.0}, {40.0, 1.0}}), 0.2), 0.6, kRounding);
  EXPECT_NEAR(probability_within(predicted({{20.0, 0.0}, {24.0, 0.5}, {36.0, 0.5}, {40.0, 1.0}}), 0.2), 0.0, kRounding);
  // Late ends are cut at 50 months with F = 0.8, and count there: of 36 .. 54 it holds 1 - 0.8 * 26/40.
  EXPECT_NEAR(probability_within(predicted({{10.0, 0.0}, {50.0, 0.8}}, 45.0), 0.2), 0.48, kRounding);
}

TEST(Saxena, ANumberWithoutDistributionIsCertain) {
  PredictedMonth month{.scored = {.time_months = 70.0, .true_rul_months = 30.0, .rul_months = 35.0}};
  EXPECT_EQ(probability_within(month, 0.2), 1.0);
  EXPECT_EQ(probability_within(month, 0.1), 0.0);
  month.scored.rul_months = 0.0;  // past the threshold
  EXPECT_EQ(probability_within(month, 0.2), 0.0);
  month.scored.rul_months.reset();  // silent
  EXPECT_EQ(probability_within(month, 0.2), 0.0);
}

// The median meets the truth, so that the yes-or-no form is content; but F(33) = 0.6 + 0.4 * 2/69 and F(27) =
// 0.4 * 17/19, so that only a quarter of the forecast lies within 10 %.
TEST(Saxena, AlphaLambdaMassAsksTheDistributionNotItsMedian) {
  const PredictedMonth vague = predicted({{10.0, 0.0}, {29.0, 0.4}, {31.0, 0.6}, {100.0, 1.0}});
  EXPECT_EQ(alpha_lambda_accuracy({&vague.scored, 1}, 0.1, 0.5), true);
  const auto judged = alpha_lambda_mass({&vague, 1}, 0.1, 0.5);
  ASSERT_TRUE(judged);
  EXPECT_NEAR(judged->probability, 0.6 + 0.8 / 69.0 - 6.8 / 19.0, kRounding);
  EXPECT_FALSE(judged->accurate);
  EXPECT_TRUE(alpha_lambda_mass({&vague, 1}, 0.1, 0.5, 0.25)->accurate);
  const PredictedMonth exactly_half = predicted({{20.0, 0.0}, {25.0, 0.25}, {35.0, 0.75}, {40.0, 1.0}});
  EXPECT_TRUE(alpha_lambda_mass({&exactly_half, 1}, 1.0 / 6.0, 0.5, 0.5 - kRounding)->accurate);
}

// As above: t_P = 40, half of the way to 100 is 70. The months before and after it say something else.
TEST(Saxena, AlphaLambdaMassIsJudgedInTheSameMonth) {
  std::vector<PredictedMonth> months;
  for (const ScoredMonth& scored : life(100.0, 30.0, 10.0, {std::nullopt, 50.0, 40.0, 30.0, 8.0, 5.0, 5.0}))
    months.push_back({.scored = scored});
  months[4].distribution = predicted({{20.0, 0.0}, {40.0, 1.0}}).distribution;
  EXPECT_NEAR(alpha_lambda_mass(months, 0.2, 0.5)->probability, 0.6, kRounding);
  EXPECT_EQ(alpha_lambda_mass(months, 0.2, 0.0)->probability, 0.0);
  months[4] = {.scored = {.time_months = 70.0, .true_rul_months = 30.0, .rul_months = std::nullopt}};
  EXPECT_FALSE(alpha_lambda_mass(months, 0.2, 0.5)->accurate);
  EXPECT_FALSE(alpha_lambda_mass({months.data(), 1}, 0.2, 0.5));
}

TEST(Saxena, LateForecastsCostMore) {
  EXPECT_NEAR(*asymmetric_score(life(100.0, 50.0, 10.0, {10.0})), std::exp(1.0) - 1.0, kRounding);
  EXPECT_NEAR(*asymmetric_score(life(100.0, 50.0, 10.0, {-13.0})), std::exp(1.0) - 1.0, kRounding);
  EXPECT_FALSE(asymmetric_score(life(100.0, 50.0, 10.0, {std::nullopt})));
}

// max(3, 0.25 r*): at 40 months left 10 are allowed, at 8 months three.
TEST(Model7, ReliableIsFromTheFirstMonthAfterWhichItHoldsToTheEnd) {
  const auto months = life(100.0, 60.0, 4.0, {9.0, 20.0, 7.0, 6.0, -5.0, 5.0, 3.0, 3.0, -2.0, 1.0});
  const LifeVerdict verdict = judge_life(months);
  ASSERT_TRUE(verdict.reliable);
  EXPECT_EQ(verdict.reliable->lead_months, 32.0);  // the hit at 40 months does not last
  EXPECT_NEAR(verdict.reliable->mean_error_months, (7.0 + 6.0 + 5.0 + 5.0 + 3.0 + 3.0 + 2.0 + 1.0) / 8.0, kRounding);
  EXPECT_TRUE(verdict.timely);
  ASSERT_TRUE(verdict.converged);
  EXPECT_EQ(verdict.converged->lead_months, 32.0);
  EXPECT_EQ(verdict.final_error_months, 1.0);
  EXPECT_NEAR(*verdict.last_year_error_months, 2.0, kRounding);  // at 12, 8 and 4 months: 3, 2, 1
}

TEST(Model7, ConvergedIsTwiceAsPatient) {
  const auto months = life(60.0, 20.0, 10.0, {15.0, 14.0, 5.0, 5.0});
  EXPECT_EQ(judge_life(months).converged->lead_months, 40.0);
  EXPECT_EQ(judge_life(months).reliable, std::nullopt);  // 5 months at 10 months left
}

TEST(Model7, SilenceIsNotReliable) {
  const auto months = life(40.0, 10.0, 10.0, {0.0, 0.0, std::nullopt});
  EXPECT_FALSE(judge_life(months).reliable);
  const auto recovers = life(40.0, 10.0, 10.0, {0.0, std::nullopt, 0.0});
  EXPECT_EQ(judge_life(recovers).reliable->lead_months, 10.0);
  EXPECT_FALSE(judge_life(recovers).timely);
  EXPECT_FALSE(judge_life({}).reliable);
}

// Due from 12 months on: alarms at 14 (false), 11 (right); at 10 and 5 none is given.
TEST(Model7, AlarmsAreCountedByTheBookingTime) {
  std::vector<ScoredMonth> months;
  for (const auto& [left, said] : std::vector<std::pair<double, std::optional<double>>>{
           {30.0, 40.0}, {14.0, 11.0}, {11.0, 9.0}, {10.0, 15.0}, {5.0, std::nullopt}})
    months.push_back({.time_months = 50.0 - left, .true_rul_months = left, .rul_months = said});
  const AlarmCounts alarms = count_alarms(months, 12.0);
  EXPECT_EQ(alarms.due, 3);
  EXPECT_EQ(alarms.not_due, 2);
  EXPECT_EQ(alarms.false_positive, 1);
  EXPECT_EQ(alarms.false_negative, 2);
}

TEST(Model7, ForecastsAreReadByTheirState) {
  Forecast forecast;
  forecast.state = ForecastState::ok;
  forecast.rul_months = 20.0;
  forecast.interval_95_low_months = 15.0;
  forecast.interval_95_high_months = 28.0;
  EXPECT_EQ(scored_month(forecast, 5.0, 18.0).error_months(), 2.0);
  EXPECT_EQ(scored_month(forecast, 5.0, 18.0).width_95_months, 13.0);
  forecast.state = ForecastState::past_threshold;
  EXPECT_EQ(scored_month(forecast, 5.0, 18.0).rul_months, 0.0);
  for (const ForecastState state : {ForecastState::no_significant_trend, ForecastState::insufficient_history}) {
    forecast.state = state;
    EXPECT_FALSE(scored_month(forecast, 5.0, 18.0).rul_months);
  }
}

TEST(Model7, MonthsMustBelongToOneLife) {
  EXPECT_TRUE(check_months(life(100.0, 50.0, 10.0, {0.0, 0.0})));
  auto months = life(100.0, 50.0, 10.0, {0.0, 0.0});
  std::swap(months[0], months[1]);
  EXPECT_FALSE(check_months(months));
  months[1] = months[0];
  EXPECT_FALSE(check_months(months));  // a month twice
  auto two_ends = life(100.0, 50.0, 10.0, {0.0, 0.0});
  two_ends[1].true_rul_months = 10.0;
  EXPECT_FALSE(check_months(two_ends));
  EXPECT_FALSE(check_months(life(100.0, 100.0, 1.0, {0.0})));  // nothing left
}

TEST(Coble, Monotonicity) {
  EXPECT_EQ(*monotonicity(std::vector<Feature>{{1.0, 0.9, 0.8}, {1.0, 0.7, 0.6}}), 1.0);
  EXPECT_NEAR(*monotonicity(std::vector<Feature>{{1.0, 0.9, 0.95, 0.8, 0.7}}), 0.5, kRounding);  // 3 falls, 1 rise
  EXPECT_FALSE(monotonicity({}));
  EXPECT_FALSE(monotonicity(std::vector<Feature>{{1.0}}));
}

TEST(Coble, TrendabilityIsTheWorstCorrelationAtTheSameShareOfLife) {
  const Feature straight{1.0, 0.8, 0.6};
  const Feature longer{1.0, 0.9, 0.8, 0.7, 0.6};
  EXPECT_NEAR(*trendability(std::vector<Feature>{straight, longer}), 1.0, kRounding);
  const Feature bump{0.6, 1.0, 0.6};
  EXPECT_NEAR(*trendability(std::vector<Feature>{straight, longer, bump}), 0.0, 1e-9);
  EXPECT_FALSE(trendability(std::vector<Feature>{straight}));
}

TEST(Coble, PrognosabilityIsHowMuchLastValuesScatter) {
  EXPECT_EQ(*prognosability(std::vector<Feature>{{1.0, 0.6}, {0.9, 0.6}}), 1.0);
  EXPECT_NEAR(*prognosability(std::vector<Feature>{{1.0, 0.5}, {1.0, 0.7}}), std::exp(-std::sqrt(0.02) / 0.4), 1e-9);
  EXPECT_FALSE(prognosability(std::vector<Feature>{{1.0, 1.0}, {0.5, 0.5}}));
}

}  // namespace
}  // namespace sealwatch::forecast
