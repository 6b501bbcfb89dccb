// States, windows and numbers of the forecasters.
#include "sealwatch/forecast/forecaster.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sealwatch/forecast/ols.hpp"
#include "tests/unit/forecast/lives.hpp"

namespace sealwatch::forecast {
namespace {

using test::month;
using test::straight_life;
using testing::HasSubstr;

constexpr double kNanosecondRounding_months = 1e-6;

Forecast ask(const std::string& method, int window, std::vector<ConditionSample> history,
             std::vector<FailureHorizon> horizons = {}) {
  const UtcTime now = history.empty() ? month(1) : history.back().time;
  auto forecaster = make_forecaster({method, window});
  return (*forecaster)
      ->forecast({.history = std::move(history),
                  .threshold = 0.60,
                  .now = now,
                  .installed = test::kInstalled,
                  .horizons = std::move(horizons)})
      .value();
}

void expect_no_numbers(const Forecast& f) {
  for (const double value : {f.rul_months, f.rul_p10_months, f.rul_p50_months, f.rul_p90_months,
                             f.interval_95_low_months, f.interval_95_high_months})
    EXPECT_EQ(value, 0.0);
}

// theta = 1 - 0.004 t reaches 0.60 at t = 100 months; 40 tests leave 60 months.
TEST(Ols, StraightLifeEndsWhereTheLineEnds) {
  for (const int window : {24, 36}) {
    const Forecast f = ask("ols", window, straight_life(40, 0.004, 0.001));
    ASSERT_EQ(f.state, ForecastState::ok) << f.explanation;
    EXPECT_EQ(f.tests_used, window);
    EXPECT_NEAR(f.rul_months, 60.0, kNanosecondRounding_months);
    EXPECT_EQ(f.rul_p50_months, f.rul_months);
    EXPECT_LT(f.interval_95_low_months, f.rul_p10_months);
    EXPECT_LT(f.rul_p10_months, f.rul_p50_months);
    EXPECT_LT(f.rul_p50_months, f.rul_p90_months);
    EXPECT_LT(f.rul_p90_months, f.interval_95_high_months);
    EXPECT_EQ(f.end_of_life_ns, add_months(month(40), f.rul_months).nanoseconds);
  }
}

// theta = 1 - 0.08 ln t reaches 0.60 at t = exp(5) = 148.4 months.
TEST(OlsLogTime, LogarithmicLifeEndsWhereTheLawEnds) {
  std::vector<ConditionSample> life;
  for (int n = 1; n <= 50; ++n) life.push_back({month(n), 1.0 - 0.08 * std::log(n), 0.001});
  const Forecast f = ask("ols_log_time", 36, life);
  ASSERT_EQ(f.state, ForecastState::ok) << f.explanation;
  EXPECT_NEAR(f.rul_months, std::exp(5.0) - 50.0, 1e-3);
  EXPECT_LT(ask("ols", 36, life).rul_months, f.rul_months);  // a straight line does not know that the fall slows down
}

TEST(Ols, LargerStandardErrorsOfPemWidenTheInterval) {
  double narrower = 0.0;
  for (const double std_error : {0.0005, 0.002, 0.008}) {
    const Forecast f = ask("ols", 36, straight_life(40, 0.004, std_error));
    ASSERT_EQ(f.state, ForecastState::ok);
    EXPECT_GT(f.interval_95_high_months - f.interval_95_low_months, 2.0 * narrower);
    narrower = f.interval_95_high_months - f.interval_95_low_months;
  }
}

// The textbook interval of inverse regression, by its own formula: h^2 - a g with all scatter, solved here anew.
TEST(OlsFieller, IsTheTextbookInterval) {
  std::mt19937_64 random(11);
  const auto life = test::with_noise(straight_life(36, 0.004, 0.0), 0.003, random);
  const Forecast f = ask("ols_fieller", 36, life);
  double mean_t = 0.0;
  double mean_theta = 0.0;
  std::vector<double> t;
  for (const ConditionSample& sample : life) {
    t.push_back(months_between(test::kInstalled, sample.time));
    mean_t += t.back() / 36.0;
    mean_theta += sample.condition / 36.0;
  }
  double S_tt = 0.0;
  double S_ty = 0.0;
  for (std::size_t i = 0; i < 36; ++i) {
    S_tt += std::pow(t[i] - mean_t, 2);
    S_ty += (t[i] - mean_t) * (life[i].condition - mean_theta);
  }
  const double b = S_ty / S_tt;
  double squares = 0.0;
  for (std::size_t i = 0; i < 36; ++i) squares += std::pow(life[i].condition - mean_theta - b * (t[i] - mean_t), 2);
  const double s2 = squares / 34.0;
  constexpr double kT = 2.0322445;  // Student's t, 34 degrees of freedom, 97.5 %
  const double g = kT * kT * s2 / (b * b * S_tt);
  const double D = (0.60 - mean_theta) / b;
  const double half = kT * std::sqrt(s2) / std::abs(b) * std::sqrt((1.0 - g) * (1.0 + 1.0 / 36.0) + D * D / S_tt);
  const double now = months_between(test::kInstalled, life.back().time);
  EXPECT_NEAR(f.interval_95_low_months, mean_t + (D - half) / (1.0 - g) - now, 1e-4);
  EXPECT_NEAR(f.interval_95_high_months, mean_t + (D + half) / (1.0 - g) - now, 1e-4);
  EXPECT_EQ(f.rul_months, ask("ols", 36, life).rul_months);
}

TEST(OlsDrift, CarriesThatTheSlopeWillChange) {
  const Forecast straight = ask("ols", 36, straight_life(40, 0.004, 0.001));
  const Forecast drift = ask("ols_drift", 36, straight_life(40, 0.004, 0.001));
  EXPECT_GT(drift.rul_p90_months, straight.rul_p90_months + 5.0);
  EXPECT_LT(drift.rul_p10_months, straight.rul_p10_months - 5.0);
}

TEST(Ols, FailureProbabilityOfCampaigns) {
  const Forecast f = ask("ols", 36, straight_life(40, 0.004, 0.004),
                         {{"past", month(39)}, {"early", month(60)}, {"middle", month(100)}, {"late", month(160)}});
  ASSERT_EQ(f.failure_probability.size(), 3u);  // the campaign that is over is passed over
  EXPECT_EQ(f.failure_probability[0].label, "early");
  EXPECT_LT(f.failure_probability[0].probability, 0.01);
  EXPECT_NEAR(f.failure_probability[1].probability, 0.5, 1e-6);
  EXPECT_GT(f.failure_probability[2].probability, 0.99);
}

TEST(Ols, WindowIsTheLastMonthsByTime) {
  auto life = straight_life(40, 0.001, 0.001);
  auto faster = straight_life(30, 0.0, 0.001);
  for (std::size_t n = 0; n < faster.size(); ++n) {
    const double t = 41.0 + static_cast<double>(n);
    life.push_back({month(t), 0.96 - 0.005 * (t - 40.0), 0.001});
  }
  const Forecast f = ask("ols", 24, life);  // sees the fast part alone: 0.81 now, 42 months to 0.60
  EXPECT_NEAR(f.rul_months, 42.0, kNanosecondRounding_months);
  EXPECT_GT(ask("ols", 48, life).rul_months, 45.0);
}

TEST(Ols, MissingMonthsAreSimplyMissing) {
  auto life = straight_life(60, 0.004, 0.001);
  for (const int gone : {50, 44, 43, 30}) life.erase(life.begin() + gone);
  const Forecast f = ask("ols", 36, life);
  EXPECT_EQ(f.tests_used, 32);
  EXPECT_NEAR(f.rul_months, 40.0, kNanosecondRounding_months);
}

TEST(Ols, RemainingLifeCountsFromNowNotFromTheLastTest) {
  auto forecaster = make_forecaster({"ols", 36});
  const Forecast f = (*forecaster)
                         ->forecast({.history = straight_life(40, 0.004, 0.001), .threshold = 0.60, .now = month(45)})
                         .value();
  EXPECT_NEAR(f.rul_months, 55.0, kNanosecondRounding_months);
  EXPECT_THAT(f.explanation, HasSubstr("5 months ago"));
}

TEST(States, InsufficientHistory) {
  const Forecast none = ask("ols", 24, {});
  EXPECT_EQ(none.state, ForecastState::insufficient_history);
  const Forecast young = ask("ols", 24, straight_life(12, 0.004, 0.001));
  EXPECT_EQ(young.state, ForecastState::insufficient_history);
  EXPECT_THAT(young.explanation, HasSubstr("12 usable tests"));
  expect_no_numbers(young);
  EXPECT_EQ(ask("ols", 24, straight_life(24, 0.004, 0.001)).state, ForecastState::ok);
  auto sparse = straight_life(40, 0.004, 0.001);  // long enough, but 11 tests in the last 24 months
  sparse.erase(sparse.begin() + 17, sparse.begin() + 30);
  EXPECT_EQ(ask("ols", 24, sparse).state, ForecastState::insufficient_history);
}

TEST(States, NoSignificantTrend) {
  std::mt19937_64 random(3);
  const Forecast flat = ask("ols", 36, test::with_noise(straight_life(40, 0.0, 0.002), 0.002, random));
  EXPECT_EQ(flat.state, ForecastState::no_significant_trend);
  expect_no_numbers(flat);
  EXPECT_EQ(ask("ols", 36, straight_life(40, -0.002, 0.001)).state, ForecastState::no_significant_trend);
  // PEM too unsure of itself to see 36 months of a slow fall.
  EXPECT_EQ(ask("ols", 36, straight_life(40, 0.001, 0.05)).state, ForecastState::no_significant_trend);
  const Forecast slow = ask("ols", 36, straight_life(40, 0.0004, 1e-5));  // ends after 1000 months
  EXPECT_EQ(slow.state, ForecastState::no_significant_trend);
  EXPECT_THAT(slow.explanation, HasSubstr("600 months"));
  expect_no_numbers(slow);
}

TEST(States, PastThreshold) {
  const Forecast past = ask("ols", 36, straight_life(102, 0.004, 0.001), {{"next", month(110)}});
  EXPECT_EQ(past.state, ForecastState::past_threshold);
  expect_no_numbers(past);
  EXPECT_EQ(past.end_of_life_ns, month(102).nanoseconds);
  EXPECT_EQ(past.failure_probability.at(0).probability, 1.0);
  // Also without a trend and without a full window: the measurement speaks for itself.
  EXPECT_EQ(ask("ols", 36, {{month(1), 0.55, 0.01}}).state, ForecastState::past_threshold);
}

TEST(States, OneLowMonthDoesNotMeanPastThreshold) {
  auto life = straight_life(80, 0.004, 0.001);
  life.back().condition = 0.58;
  EXPECT_NE(ask("ols", 36, life).state, ForecastState::past_threshold);
}

// Whatever the history, numbers are finite, ordered and not negative in `ok`, and zero otherwise.
TEST(States, NumbersAreSoundForRandomHistories) {
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  int ok = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const double noise = std::pow(10.0, -4.0 + 3.0 * uniform(random));
    auto life = test::with_noise(
        straight_life(static_cast<int>(10 + 80 * uniform(random)), 0.006 * uniform(random), noise), noise, random);
    const auto& methods = forecast_methods();
    const Forecast f = ask(methods[static_cast<std::size_t>(trial) % methods.size()], 24, life,
                           {{"c", add_months(life.back().time, 12)}});
    if (f.state != ForecastState::ok) {
      expect_no_numbers(f);
      continue;
    }
    ++ok;
    for (const double value : {f.rul_months, f.interval_95_low_months, f.interval_95_high_months})
      EXPECT_TRUE(std::isfinite(value) && value >= 0.0);
    EXPECT_LE(f.interval_95_low_months, f.rul_p10_months);
    EXPECT_LE(f.rul_p10_months, f.rul_p50_months);
    EXPECT_LE(f.rul_p50_months, f.rul_p90_months);
    EXPECT_LE(f.rul_p90_months, f.interval_95_high_months);
    EXPECT_GE(f.failure_probability.at(0).probability, 0.0);
    EXPECT_LE(f.failure_probability.at(0).probability, 1.0);
  }
  EXPECT_GT(ok, 500);
}

TEST(Panel, WindowsThatSeeDifferentRatesDisagree) {
  const auto panel = ForecastPanel::make({{"ols", 24}, {"ols", 48}});
  auto life = straight_life(48, 0.002, 0.0005);
  for (int n = 49; n <= 66; ++n) life.push_back({month(n), life[47].condition - 0.008 * (n - 48), 0.0005});
  const auto answer = panel->forecast({.history = life, .threshold = 0.60, .now = life.back().time}).value();
  EXPECT_TRUE(answer.windows_disagree);
  EXPECT_THAT(answer.disagreement, HasSubstr("ageing has become faster: the last 24 months of tests give"));
  const auto steady =
      panel->forecast({.history = straight_life(66, 0.004, 0.001), .threshold = 0.60, .now = month(66)}).value();
  EXPECT_FALSE(steady.windows_disagree);
}

TEST(Panel, OrderOfArrivalDoesNotMatterAndOutliersAreNamed) {
  const auto panel = ForecastPanel::make(default_forecasters());
  std::mt19937_64 random(8);
  auto life = test::with_noise(straight_life(60, 0.004, 0.002), 0.002, random);
  life[50].condition = 0.95;
  const auto in_order = panel->forecast({.history = life, .threshold = 0.60, .now = month(60)}).value();
  EXPECT_THAT(in_order.left_out, testing::ElementsAre(life[50]));
  EXPECT_EQ(in_order.forecasts.front().method, "state_space");
  EXPECT_EQ(in_order.forecasts.front().window_months, kWholeLife_months);
  std::shuffle(life.begin(), life.end(), random);
  const auto shuffled = panel->forecast({.history = life, .threshold = 0.60, .now = month(60)}).value();
  EXPECT_EQ(shuffled.forecasts, in_order.forecasts);
}

// A line over ln t bends away from a straight history, so that its windows always differ: that is no change of rate.
TEST(Panel, StraightHistoriesDoNotDisagree) {
  const auto panel = ForecastPanel::make(default_forecasters());
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 20; ++trial) {
    const auto answer = panel
                            ->forecast({.history = test::with_noise(straight_life(66, 0.004, 0.001), 0.001, random),
                                        .threshold = 0.60,
                                        .now = month(66),
                                        .installed = test::kInstalled})
                            .value();
    EXPECT_FALSE(answer.windows_disagree) << answer.disagreement;
  }
}

TEST(Panel, WhatIsNoNumberIsLeftOut) {
  const auto panel = ForecastPanel::make(default_forecasters());
  const auto clean = straight_life(60, 0.004, 0.001);
  auto spoiled = clean;
  spoiled.push_back(clean[20]);  // delivered twice
  spoiled.push_back({month(30.5), std::nan(""), 0.001});
  spoiled.push_back({month(31.5), 0.9, -0.001});
  spoiled.push_back({month(32.5), 1e287, 0.001});  // finite, but its square is not
  spoiled.push_back({month(33.5), 0.9, 1e287});
  const auto answer = panel->forecast({.history = spoiled, .threshold = 0.60, .now = month(60)}).value();
  EXPECT_EQ(answer.left_out.size(), 4u);
  EXPECT_EQ(answer.used.size(), 60u);
  EXPECT_EQ(answer.forecasts,
            panel->forecast({.history = clean, .threshold = 0.60, .now = month(60)}).value().forecasts);
}

TEST(Panel, AHistoryOfNoNumbersIsNoHistory) {
  const auto panel = ForecastPanel::make(default_forecasters());
  std::vector<ConditionSample> nonsense;
  for (int k = 1; k <= 30; ++k) nonsense.push_back({month(k), 1e287, 0.001});
  const auto answer = panel->forecast({.history = nonsense, .threshold = 0.60, .now = month(30)}).value();
  EXPECT_TRUE(answer.used.empty());
  for (const Forecast& forecast : answer.forecasts) {
    EXPECT_EQ(forecast.state, ForecastState::insufficient_history) << forecast.method;
    expect_no_numbers(forecast);
  }
}

TEST(Panel, EachNumberComesWithItsDistribution) {
  const auto panel = ForecastPanel::make(default_forecasters());
  const auto answer =
      panel->forecast({.history = straight_life(60, 0.004, 0.001), .threshold = 0.60, .now = month(60)}).value();
  ASSERT_EQ(answer.distributions.size(), answer.forecasts.size());
  for (std::size_t i = 0; i < answer.forecasts.size(); ++i) {
    ASSERT_TRUE(answer.distributions[i]) << answer.forecasts[i].method;
    EXPECT_EQ(answer.distributions[i]->quantile(0.5), answer.forecasts[i].rul_months);
    EXPECT_EQ(answer.distributions[i]->quantile(0.1), answer.forecasts[i].rul_p10_months);
  }
}

TEST(Panel, SettingsAreChecked) {
  const auto unknown = ForecastPanel::make({{"olz", 36}});
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().describe(), HasSubstr("did you mean 'ols'"));
  EXPECT_FALSE(ForecastPanel::make({}));
  EXPECT_FALSE(ForecastPanel::make({{"ols", 2}}));
  EXPECT_FALSE(OlsForecaster::make({.significance = 0.2}));
  EXPECT_FALSE(OlsForecaster::make({.slope_drift = -0.1}));
}

TEST(Panel, AThresholdThatIsNoneIsAnError) {
  const auto panel = ForecastPanel::make(default_forecasters());
  const auto life = straight_life(60, 0.004, 0.001);
  for (const double threshold : {std::nan(""), 0.0, -0.6, 1.5, std::numeric_limits<double>::infinity()}) {
    const ForecastRequest request{.history = life, .threshold = threshold, .now = month(60)};
    const auto answer = panel->forecast(request);
    ASSERT_FALSE(answer) << threshold;
    EXPECT_THAT(answer.error().describe(), HasSubstr("must be above 0, at most 1"));
    for (const std::string& method : forecast_methods()) {
      const auto forecaster = make_forecaster({method, 36}).value();
      EXPECT_FALSE(forecaster->predict(request)) << method << " at " << threshold;
      EXPECT_FALSE(forecaster->forecast(request)) << method << " at " << threshold;
    }
  }
}

}  // namespace
}  // namespace sealwatch::forecast
