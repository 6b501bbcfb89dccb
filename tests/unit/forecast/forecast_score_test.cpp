// Self-scoring, and the average that it weighs.
#include "sealwatch/forecast/forecast_score.hpp"

#include <gmock/gmock.h>

#include "sealwatch/forecast/forecast_average.hpp"
#include "tests/unit/forecast/random_life.hpp"

namespace sealwatch::forecast {
namespace {

using test::month;

ConditionScore with_z(double z) {
  return score_condition({.time = month(10), .condition = 0.8, .condition_std = 0.003}, month(4),
                         {month(10), 0.8 + 0.005 * z, 0.004});
}

TEST(ForecastScore, CountsBothErrors) {
  const ConditionScore score = with_z(1.0);
  EXPECT_NEAR(score.predicted_std, 0.005, 1e-12);
  EXPECT_NEAR(score.probability, 0.841345, 1e-6);
  EXPECT_FALSE(with_z(1.3).within_80);
  EXPECT_TRUE(with_z(1.3).within_95);
  EXPECT_FALSE(with_z(-2.0).within_95);
  EXPECT_LT(with_z(0.0).crps, with_z(1.0).crps);
}

// CRPS of a normal (Gneiting and Raftery 2007): s (z (2 Phi(z) - 1) + 2 phi(z) - 1/sqrt(pi)), here with s = 0.005:
//   z = 0: 0.005 (2 0.3989423 - 0.5641896)                   z = 1: 0.005 (0.6826895 + 2 0.2419707 - 0.5641896)
TEST(ForecastScore, MeanCrpsIsTheMeanOfTheScores) {
  constexpr double kAtZero = 0.00116847;
  constexpr double kAtOne = 0.00301221;
  EXPECT_NEAR(with_z(0.0).crps, kAtZero, 1e-8);
  EXPECT_NEAR(with_z(1.0).crps, kAtOne, 1e-8);
  const std::vector<ConditionScore> scores = {with_z(0.0), with_z(1.0), with_z(-1.0)};
  EXPECT_NEAR(summarise(scores).mean_crps, (kAtZero + 2.0 * kAtOne) / 3.0, 1e-8);
}

TEST(ForecastScore, ConfidenceRisesSlowlyAndFallsAtOnce) {
  std::vector<ConditionScore> scores;
  EXPECT_EQ(summarise(scores).confidence, kPriorConfidence);
  for (const double z : {0.3, -0.8, 1.1, -0.2, 0.6}) scores.push_back(with_z(z));
  const ScoreSummary good = summarise(scores);
  EXPECT_GT(good.confidence, 0.99);
  EXPECT_EQ(good.coverage_95, 1.0);
  EXPECT_EQ(good.forecasts, 5);
  scores.push_back(with_z(-4.0));
  scores.push_back(with_z(-5.0));
  EXPECT_LT(summarise(scores).confidence, 0.1);
  EXPECT_NEAR(summarise(scores).coverage_95, 5.0 / 7.0, 1e-12);
}

ForecastRequest history_of(std::uint64_t seed, const std::string& scenario, std::size_t tests) {
  ForecastRequest request{.threshold = 0.6, .installed = test::kInstalled};
  for (const auto& one : test::random_life(seed, scenario, 0.003, 0.6).months)
    if (one.sample && request.history.size() < tests) request.history.push_back(*one.sample);
  request.now = request.history.back().time;
  return request;
}

// On seals of the law the state-space model's forecasts of the condition cover as they say.
TEST(ForecastScore, PastForecastsOfTheLawAreCalibrated) {
  const auto forecaster = make_forecaster({"state_space", kWholeLife_months}).value();
  int within_80 = 0;
  int forecasts = 0;
  double confidence = 0.0;
  constexpr int kLives = 60;
  for (std::uint64_t seed = 1; seed <= kLives; ++seed) {
    const ForecastRequest request = history_of(seed, "reference", 90);
    const auto scores = score_past_forecasts(*forecaster, request, 6.0, 8);
    ASSERT_EQ(scores.size(), 8u);
    EXPECT_EQ(scores.front().scored, request.history.back().time);
    EXPECT_LE(months_between(scores.front().made, scores.front().scored), 6.5);
    for (const ConditionScore& score : scores) within_80 += score.within_80;
    forecasts += 8;
    confidence += summarise(scores).confidence / kLives;
  }
  EXPECT_NEAR(within_80 / static_cast<double>(forecasts), 0.80, 0.06);  // three standard errors
  EXPECT_GT(confidence, 0.95);
}

TEST(ForecastScore, ConfidenceFallsWhenTheSealDrifts) {
  const auto forecaster = make_forecaster({"state_space", kWholeLife_months}).value();
  ForecastRequest request = history_of(3, "reference", 90);
  const double before = summarise(score_past_forecasts(*forecaster, request, 6.0, 4)).confidence;
  for (std::size_t n = 80; n < 90; ++n) request.history[n].condition -= 0.004 * static_cast<double>(n - 79);
  const double after = summarise(score_past_forecasts(*forecaster, request, 6.0, 4)).confidence;
  EXPECT_GT(before, 0.9);
  EXPECT_LT(after, 0.1);
}

TEST(ForecastScore, ShortHistoriesHaveNothingToScore) {
  const auto forecaster = make_forecaster({"ols", 36}).value();
  EXPECT_TRUE(score_past_forecasts(*forecaster, {.threshold = 0.6}, 6.0, 4).empty());
  EXPECT_TRUE(score_past_forecasts(*forecaster, history_of(1, "reference", 20), 6.0, 4).empty());
}

double weight_of_law(const std::string& scenario, std::size_t tests) {
  const auto average = AverageForecaster::make({"average", kWholeLife_months}).value();
  const auto& concrete = dynamic_cast<const AverageForecaster&>(*average);
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    sum += concrete.weights(history_of(seed, scenario, tests)).front() / 20.0;
  return sum;
}

TEST(Average, BelievesTheLawUntilItFails) {
  const double usual = weight_of_law("reference", 96);
  EXPECT_GT(usual, 0.25);                               // of four members
  EXPECT_LT(weight_of_law("triple", 78), 0.7 * usual);  // half a year after it has begun to age three times as fast
  EXPECT_GT(weight_of_law("triple", 88), 0.7 * usual);  // seen by then
}

TEST(Average, MembersAreChecked) {
  ForecasterSettings settings{"average", kWholeLife_months};
  settings.members = {{"average", 36}};
  EXPECT_FALSE(make_forecaster(settings));
  settings.members = {{"olz", 36}};
  EXPECT_THAT(make_forecaster(settings).error().describe(), testing::HasSubstr("did you mean 'ols'"));
  settings.members = {{"ols", 24}, {"ols", 48}};
  const Forecast f = make_forecaster(settings).value()->forecast(history_of(1, "reference", 60)).value();
  ASSERT_EQ(f.state, ForecastState::ok) << f.explanation;
  EXPECT_THAT(f.explanation, testing::HasSubstr("weights by past scores: ols 24"));
}

TEST(Average, SaysTheStateOfItsMembersWhereNoneHasANumber) {
  ForecastRequest past{.history = test::straight_life(103, 0.004, 0.001), .threshold = 0.6, .now = month(103)};
  EXPECT_EQ(make_forecaster({"average", kWholeLife_months}).value()->forecast(past).value().state,
            ForecastState::past_threshold);
  past.history.clear();
  EXPECT_EQ(make_forecaster({"average", kWholeLife_months}).value()->forecast(past).value().state,
            ForecastState::insufficient_history);
}

}  // namespace
}  // namespace sealwatch::forecast
