// How forecasts do on seals that age by the reference recursion (docs/model.md), which no straight line follows: the
// claims of docs/forecast.md that decisions depend on.
#include <gtest/gtest.h>

#include <cmath>

#include "sealwatch/forecast/degradation.hpp"
#include "sealwatch/forecast/forecaster.hpp"
#include "tests/unit/forecast/lives.hpp"

namespace sealwatch::forecast {
namespace {

constexpr double kNoise = 0.003;  // of theta, one estimate
constexpr int kLives = 300;

struct Outcome {
  int forecasts = 0;
  double before_p10 = 0.0;  ///< share that failed before P10
  double of_80 = 0.0;
  double error_months = 0.0;  ///< mean
};

/// One forecast in each life, at a true remaining life of about `rul_months`.
Outcome forecast_lives(const ForecasterSettings& settings, double rul_months) {
  const auto forecaster = make_forecaster(settings).value();
  Outcome outcome;
  for (std::uint64_t seed = 1; seed <= kLives; ++seed) {
    Degradation seal(seed);
    std::vector<ConditionSample> life;
    while (seal.condition() > 0.6) {
      const double condition = seal.advance();
      life.push_back({test::month(seal.month()), condition, kNoise});
    }
    const double end = seal.month() - 0.5;  // crossed within the last month
    const auto tests = static_cast<std::size_t>(std::max(0.0, end - rul_months));
    if (tests < 50) continue;
    life.resize(tests);
    std::mt19937_64 random(seed);
    life = test::with_noise(life, kNoise, random);
    const Forecast f =
        forecaster
            ->forecast({.history = life, .threshold = 0.6, .now = life.back().time, .installed = test::kInstalled})
            .value();
    if (f.state != ForecastState::ok) continue;
    const double left = end - static_cast<double>(tests);
    ++outcome.forecasts;
    outcome.before_p10 += left < f.rul_p10_months;
    outcome.of_80 += f.rul_p10_months <= left && left <= f.rul_p90_months;
    outcome.error_months += f.rul_months - left;
  }
  outcome.before_p10 /= outcome.forecasts;
  outcome.of_80 /= outcome.forecasts;
  outcome.error_months /= outcome.forecasts;
  return outcome;
}

double three_sigma(double share, int trials) { return 3.0 * std::sqrt(share * (1.0 - share) / trials); }

TEST(ReferenceLives, FewFailBeforeTheP10OfTheForecastInCharge) {
  for (const double rul : {6.0, 24.0, 48.0}) {
    const Outcome outcome = forecast_lives({"ols", 36}, rul);
    ASSERT_GT(outcome.forecasts, 200);
    EXPECT_LT(outcome.before_p10, 0.10 + three_sigma(0.10, outcome.forecasts)) << rul;
  }
}

TEST(ReferenceLives, TheEndLiesBetweenTheTwoLaws) {
  for (const double rul : {24.0, 48.0}) {
    EXPECT_LT(forecast_lives({"ols", 36}, rul).error_months, 0.0);
    EXPECT_GT(forecast_lives({"ols_log_time", 36}, rul).error_months, 0.0);
  }
}

TEST(ReferenceLives, DriftMakesTheIntervalHonest) {
  for (const double rul : {6.0, 24.0, 48.0}) {
    const Outcome outcome = forecast_lives({"ols_drift", 36}, rul);
    EXPECT_GT(outcome.of_80, 0.80 - three_sigma(0.80, outcome.forecasts)) << rul;
  }
  EXPECT_LT(forecast_lives({"ols", 36}, 48.0).of_80, 0.5);  // what it is there for
}

}  // namespace
}  // namespace sealwatch::forecast
