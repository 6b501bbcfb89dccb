// The state-space forecaster: its filter against known answers, its hypotheses against seals to which things happen.
#include "sealwatch/forecast/state_space.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "sealwatch/forecast/degradation_filter.hpp"
#include "sealwatch/forecast/proper_scores.hpp"
#include "tests/unit/forecast/random_life.hpp"

namespace sealwatch::forecast {
namespace {

using test::month;
using testing::HasSubstr;

constexpr double kThreshold = 0.60;

/// The history of a random life up to `months` before its end, and what was then left.
struct Cut {
  ForecastRequest request;
  double left = 0.0;
};
Cut cut(std::uint64_t seed, const std::string& scenario, double months_before_end, double condition_std = 0.003) {
  const test::RandomLife life = test::random_life(seed, scenario, condition_std, kThreshold);
  Cut result{.request = {.threshold = kThreshold}};
  if (life.installation_known) result.request.installed = test::kInstalled;
  for (const test::MonthOfLife& one : life.months) {
    if (life.end_months - one.state.month < months_before_end && one.foreseeable) break;
    if (!one.sample) continue;
    result.request.history.push_back(*one.sample);
    result.request.now = one.sample->time;
    result.left = life.end_months - one.state.month;
  }
  return result;
}

Forecast ask(const std::string& method, const ForecastRequest& request) {
  return make_forecaster({method, kWholeLife_months}).value()->forecast(request).value();
}

// Without noise the law is a sum: theta(n) = 1 - sum (g + mu k) ln((k + 1)/k).
TEST(DegradationFilter, CarriesTheLawOn) {
  SealBelief belief;
  belief.mean = {1.0, 0.045, 0.001};
  grow_old(belief, {}, 60.0);
  double theta = 1.0;
  for (int k = 1; k <= 60; ++k) theta -= (0.045 + 0.001 * k) * std::log((k + 1.0) / k);
  EXPECT_NEAR(belief.mean[0], theta, 1e-12);
  EXPECT_NEAR(belief.mean[1], 0.105, 1e-12);
}

// The covariance after 24 months against that of 20000 simulated seals of the recursion itself.
TEST(DegradationFilter, SpreadIsThatOfSimulatedSeals) {
  constexpr int kSeals = 20000;
  constexpr double kMonteCarlo = 5.0 / 200.0;  // five standard errors of a standard deviation
  double sum = 0.0;
  double squares = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeals; ++seed) {
    Degradation seal(seed);
    for (int n = 0; n < 24; ++n) seal.advance();
    sum += seal.condition();
    squares += seal.condition() * seal.condition();
  }
  FleetPopulation population;
  population.initial_condition_std = 1e-9;
  SealBelief belief = new_seal(population);
  grow_old(belief, {}, 24.0);
  const double mean = sum / kSeals;
  const double std = std::sqrt(squares / kSeals - mean * mean);
  EXPECT_NEAR(belief.mean[0], mean, 5.0 * std / std::sqrt(kSeals));
  EXPECT_NEAR(std::sqrt(belief.covariance[0]) / std, 1.0, kMonteCarlo);
}

// Without noise every month's fall is k times what it was; the spread of what irregularity does grows k times, too.
TEST(DegradationFilter, AgesFasterByAllOfTheLaw) {
  SealBelief usual;
  usual.mean = {0.8, 0.1, 0.001};
  usual.age_months = 60.0;
  SealBelief faster = usual;
  age_faster(faster, 1.75, 0.0);
  grow_old(usual, {}, 96.0);
  grow_old(faster, {}, 96.0);
  EXPECT_NEAR(0.8 - faster.mean[0], 1.75 * (0.8 - usual.mean[0]), 1e-12);
  EXPECT_NEAR(std::sqrt(faster.covariance[0]), 1.75 * std::sqrt(usual.covariance[0]), 1e-12);
  const auto months_left = [](const SealBelief& belief) {
    const WeightedBelief known{belief, 1.0};
    return crossing_distribution({&known, 1}, {}, 0.6, 600.0).value();
  };
  EXPECT_LT(months_left(faster).quantile(0.5), months_left(usual).quantile(0.5) / 1.5);
}

// A factor that is known to a tenth spreads the fall by a tenth of itself, in g and mu together.
TEST(DegradationFilter, FactorIsKnownToItsSpread) {
  SealBelief belief;
  belief.mean = {0.8, 0.1, 0.001};
  belief.age_months = 60.0;
  age_faster(belief, 2.0, 0.1);
  const DegradationLaw regular{.n_0 = 1.0, .steepening_scatter = 0.0, .irregularity_std = 0.0};
  grow_old(belief, regular, 96.0);
  EXPECT_NEAR(std::sqrt(belief.covariance[0]), 0.1 * (0.8 - belief.mean[0]), 1e-9);
}

TEST(DegradationFilter, GrossErrorMovesLittleAndGoodTestsMuch) {
  SealBelief belief = new_seal({});
  grow_old(belief, {}, 12.0);
  for (int n = 13; n <= 40; ++n) {
    grow_old(belief, {}, n);
    observe(belief, 0.9 - 0.002 * (n - 12), 0.003);
  }
  SealBelief gross = belief;
  observe(gross, 0.60, 0.003);
  EXPECT_NEAR(gross.mean[0], belief.mean[0], 0.001);
  SealBelief good = belief;
  observe(good, belief.mean[0] - 0.004, 0.0005);
  EXPECT_LT(good.mean[0], belief.mean[0] - 0.002);
  EXPECT_LT(good.covariance[0], belief.covariance[0]);
}

TEST(StateSpace, ForecastsAreSoundAndDeterministic) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const Cut life = cut(seed, "reference", 36.0);
    for (const std::string method : {"state_space", "fleet", "average"}) {
      const Forecast f = ask(method, life.request);
      ASSERT_EQ(f.state, ForecastState::ok) << f.explanation;
      EXPECT_EQ(f, ask(method, life.request));
      EXPECT_LE(f.interval_95_low_months, f.rul_p10_months);
      EXPECT_LT(f.rul_p10_months, f.rul_p50_months);
      EXPECT_LT(f.rul_p50_months, f.rul_p90_months);
      EXPECT_LE(f.rul_p90_months, f.interval_95_high_months);
      EXPECT_NEAR(f.rul_months, life.left, 12.0);
    }
  }
}

TEST(StateSpace, DistributionAndMessageAgree) {
  const Cut life = cut(4, "reference", 24.0);
  ForecastRequest request = life.request;
  request.horizons = {{"campaign", add_months(request.now, 20.0)}};
  const auto predicted = make_forecaster({"state_space", kWholeLife_months}).value()->predict(request).value();
  ASSERT_TRUE(predicted.distribution);
  EXPECT_EQ(predicted.forecast.rul_p10_months, predicted.distribution->quantile(0.10));
  EXPECT_NEAR(predicted.forecast.failure_probability.at(0).probability, predicted.distribution->cdf(20.0), 1e-9);
}

/// Mean absolute error over some lives, 24 months before the end.
double mean_error(const std::string& scenario, const std::string& method, int window) {
  constexpr int kLives = 40;
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= kLives; ++seed) {
    const Cut life = cut(seed, scenario, 24.0, 0.004);
    const Forecast f = make_forecaster({method, window}).value()->forecast(life.request).value();
    sum += std::abs(f.rul_months - life.left) / kLives;
  }
  return sum;
}

// What the bank of hypotheses is there for. Limits: about 1.3 times what was measured (docs/forecast.md).
TEST(StateSpace, BearsWhatHappensToHistories) {
  const double reference = mean_error("reference", "state_space", kWholeLife_months);
  EXPECT_LT(reference, mean_error("reference", "ols", 36) * 0.8);
  for (const std::string scenario : {"missing", "unknown", "late", "replaced"})
    EXPECT_LT(mean_error(scenario, "state_space", kWholeLife_months), 1.5 * reference) << scenario;
  // Of all tests: the panel leaves isolated ones out before.
  EXPECT_LT(mean_error("outliers", "state_space", kWholeLife_months), 2.0 * reference);
  for (const std::string scenario : {"outliers", "level", "replaced"})
    EXPECT_LT(mean_error(scenario, "state_space", kWholeLife_months), mean_error(scenario, "ols", 36)) << scenario;
}

/// Failures before P10, of all forecasts from half a year after the change on, life by life.
ClusteredMean before_p10(const std::string& scenario, const std::string& method) {
  constexpr int kLives = 60;
  const auto forecaster = make_forecaster({method, kWholeLife_months}).value();
  std::vector<Cluster> lives;
  for (std::uint64_t seed = 1; seed <= kLives; ++seed) {
    const test::RandomLife life = test::random_life(20000 + seed, scenario, 0.0005, kThreshold);
    Cluster& own = lives.emplace_back();
    ForecastRequest request{.threshold = kThreshold, .installed = test::kInstalled};
    for (const test::MonthOfLife& one : life.months) {
      const double left = life.end_months - one.state.month;
      request.history.push_back(*one.sample);
      request.now = one.sample->time;
      if (!one.foreseeable || one.state.month < 72.0 || left <= 0.0) continue;
      const Forecast f = forecaster->forecast(request).value();
      if (f.state != ForecastState::ok) continue;
      own.sum += left < f.rul_p10_months;
      ++own.count;
    }
  }
  return clustered_mean(lives).value();
}

// Contaminated fluid from one month on: whether the months' irregularity grows with the ageing or not, few forecasts
// are overtaken. 1.5 times as fast is less, and twice as fast more, than the forecaster expects.
TEST(StateSpace, FewFailBeforeP10AfterSealsBeganToAgeFaster) {
  for (const std::string method : {"state_space", "fleet"}) {
    for (const std::string scenario : {"reference", "rate", "regular"}) {
      const ClusteredMean share = before_p10(scenario, method);
      EXPECT_LT(share.mean, 0.10 + 2.0 * share.standard_error) << method << ", " << scenario;
    }
    EXPECT_LT(before_p10("double", method).mean, 0.22) << method;
  }
}

TEST(StateSpace, SaysWhatHappened) {
  EXPECT_THAT(ask("state_space", cut(1, "rate", 6.0, 0.0005).request).explanation, HasSubstr("another rate since"));
  EXPECT_THAT(ask("state_space", cut(3, "replaced", 24.0).request).explanation, HasSubstr("another, new one since"));
  EXPECT_THAT(ask("state_space", cut(1, "level", 12.0, 0.002).request).explanation, HasSubstr("another level since"));
  EXPECT_THAT(ask("state_space", cut(1, "errors", 24.0).request).explanation, HasSubstr("besides their errors"));
  const std::string usual = ask("state_space", cut(1, "reference", 24.0).request).explanation;
  EXPECT_THAT(usual, testing::Not(HasSubstr("since")));
}

TEST(StateSpace, States) {
  const ForecastRequest none{.threshold = kThreshold, .now = month(1)};
  EXPECT_EQ(ask("state_space", none).state, ForecastState::insufficient_history);
  ForecastRequest request{.history = test::straight_life(5, 0.004, 0.001), .threshold = kThreshold, .now = month(5)};
  EXPECT_EQ(ask("state_space", request).state, ForecastState::insufficient_history);
  EXPECT_EQ(ask("fleet", request).state, ForecastState::ok);  // the fleet says the rest
  for (ConditionSample& sample : request.history) sample.condition -= 0.5;
  EXPECT_EQ(ask("state_space", request).state, ForecastState::past_threshold);

  std::mt19937_64 random(3);
  ForecastRequest flat{.history = test::with_noise(test::straight_life(60, 0.0, 0.002), 0.002, random),
                       .threshold = kThreshold,
                       .now = month(60)};
  EXPECT_EQ(ask("state_space", flat).state, ForecastState::no_significant_trend);
  EXPECT_EQ(ask("state_space", flat).rul_months, 0.0);
  ForecastRequest over{.history = test::straight_life(103, 0.004, 0.001), .threshold = kThreshold, .now = month(103)};
  EXPECT_EQ(ask("state_space", over).state, ForecastState::past_threshold);
  over.history = test::straight_life(97, 0.004, 0.001);  // not when tested, but by now
  over.now = month(108);
  EXPECT_EQ(ask("state_space", over).state, ForecastState::past_threshold);
}

TEST(StateSpace, TestsBeforeTheInstallationDoNotCount) {
  Cut life = cut(5, "reference", 40.0);
  const Forecast expected = ask("state_space", life.request);
  for (const double before : {-2.0, -1.0})
    life.request.history.insert(life.request.history.begin(), {month(before), 0.5, 0.003});
  EXPECT_EQ(ask("state_space", life.request).rul_months, expected.rul_months);
}

TEST(StateSpace, SettingsAreChecked) {
  EXPECT_FALSE(make_forecaster({"state_space", 3}));
  ForecasterSettings settings{"fleet", kWholeLife_months};
  settings.population.irregularity_std = -1.0;
  EXPECT_THAT(make_forecaster(settings).error().describe(), HasSubstr("irregularity_std"));
  settings = {"state_space", kWholeLife_months};
  settings.change_per_month = 0.5;
  EXPECT_FALSE(make_forecaster(settings));
}

TEST(Oracle, RefusesAStateThatHasFailed) {
  EXPECT_FALSE(oracle_distribution({.month = 100.0, .condition = 0.55, .gamma = 0.1, .steepening_limit = 0.002}, 0.6));
  EXPECT_FALSE(oracle_distribution({.month = -1.0, .condition = 0.9}, 0.6));
}

// Its own forecasts are calibrated: the median is passed in half of all lives, at 24 months and at 6.
TEST(Oracle, IsCalibrated) {
  constexpr int kLives = 400;
  constexpr double kThreeSigma = 3.0 * 0.5 / 20.0;
  for (const double lead : {6.0, 24.0}) {
    int before = 0;
    for (std::uint64_t seed = 1; seed <= kLives; ++seed) {
      const test::RandomLife life = test::random_life(seed, "reference", 0.003, kThreshold);
      for (const test::MonthOfLife& one : life.months) {
        const double left = life.end_months - one.state.month;
        if (std::abs(left - lead) > 0.5) continue;
        before += left < oracle_distribution(one.state, kThreshold)->quantile(0.5);
        break;
      }
    }
    EXPECT_NEAR(before / static_cast<double>(kLives), 0.5, kThreeSigma) << lead;
  }
}

TEST(CrossingDistribution, WhatIsNoNumberIsAnError) {
  WeightedBelief known;
  known.belief = new_seal({});
  grow_old(known.belief, {}, 24.0);
  EXPECT_TRUE(crossing_distribution({&known, 1}, {}, 0.6, 600.0));
  EXPECT_FALSE(crossing_distribution({}, {}, 0.6, 600.0));
  EXPECT_FALSE(crossing_distribution({&known, 1}, {}, std::nan(""), 600.0));
  known.belief.mean[0] = std::nan("");
  EXPECT_FALSE(crossing_distribution({&known, 1}, {}, 0.6, 600.0));
  const TrueState state{.month = 24.0, .condition = 0.9, .gamma = 0.04, .steepening_limit = 0.002};
  EXPECT_TRUE(oracle_distribution(state, 0.6));
  EXPECT_FALSE(oracle_distribution(state, std::nan("")));
}

}  // namespace
}  // namespace sealwatch::forecast
