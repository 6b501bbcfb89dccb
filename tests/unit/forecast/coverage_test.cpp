// Calibration: on straight synthetic lives the true end of life must lie below the q-quantile in a share q of all
// histories, within the Monte Carlo error of that share.
#include <gtest/gtest.h>

#include <cmath>

#include "sealwatch/forecast/ols.hpp"
#include "tests/unit/forecast/lives.hpp"

namespace sealwatch::forecast {
namespace {

struct Case {
  int window_months;
  double fall_per_month;
  double noise_std;
  double pem_std;  ///< what PEM says of itself
  double rul_months;
  const char* name;
};

struct Coverage {
  int ok = 0;
  double of_80 = 0.0;
  double of_95 = 0.0;
  double before_median = 0.0;
  double mean_failure_probability = 0.0;  ///< asked for the true end of life
};

Coverage run(const Case& c, int lives, DegradationTime kind) {
  const auto forecaster =
      OlsForecaster::make({.method = "ols", .window_months = c.window_months, .time = kind, .slope_drift = 0.0});
  std::mt19937_64 random(2026);
  std::normal_distribution<double> noise(0.0, c.noise_std);
  std::uniform_real_distribution<double> jitter(-0.3, 0.3);
  const double now = c.window_months;
  const auto degradation_time = [&](double m) { return kind == DegradationTime::months ? m : 30.0 * std::log(m); };
  const double end = now + c.rul_months;
  Coverage coverage;
  for (int life = 0; life < lives; ++life) {
    ForecastRequest request{.threshold = 0.6, .now = test::month(now), .installed = test::kInstalled};
    for (int n = 1; n <= c.window_months; ++n) {
      const double m = n == c.window_months ? now : n + (n == 1 ? 0.0 : jitter(random));
      const double theta = 0.6 + c.fall_per_month * (degradation_time(end) - degradation_time(m)) + noise(random);
      request.history.push_back({test::month(m), theta, c.pem_std});
    }
    request.horizons = {{"true end of life", test::month(end)}};
    const Forecast f = (*forecaster)->forecast(request).value();
    if (f.state != ForecastState::ok) continue;
    ++coverage.ok;
    coverage.of_80 += f.rul_p10_months <= c.rul_months && c.rul_months <= f.rul_p90_months;
    coverage.of_95 += f.interval_95_low_months <= c.rul_months && c.rul_months <= f.interval_95_high_months;
    coverage.before_median += c.rul_months <= f.rul_p50_months;
    coverage.mean_failure_probability += f.failure_probability.at(0).probability;
  }
  for (double* share : {&coverage.of_80, &coverage.of_95, &coverage.before_median, &coverage.mean_failure_probability})
    *share /= coverage.ok;
  return coverage;
}

/// Three standard deviations of a share seen in `trials`.
double monte_carlo_error(double share, int trials) { return 3.0 * std::sqrt(share * (1.0 - share) / trials); }

// PEM's standard errors are believed as a lower bound of the scatter, and what the scatter has above them as the seal's
// own irregularity; both are estimates cut at zero, so intervals are a little too wide when PEM is right. Too narrow is
// not allowed.
constexpr double kSurplus = 0.08;

class CoverageTest : public testing::TestWithParam<Case> {};

TEST_P(CoverageTest, NominalIntervalsCover) {
  const Case& c = GetParam();
  constexpr int kLives = 1500;
  for (const DegradationTime kind : {DegradationTime::months, DegradationTime::log_months}) {
    const Coverage coverage = run(c, kLives, kind);
    ASSERT_GT(coverage.ok, 0.99 * kLives);
    EXPECT_GT(coverage.of_80, 0.80 - monte_carlo_error(0.80, coverage.ok));
    EXPECT_LT(coverage.of_80, 0.80 + monte_carlo_error(0.80, coverage.ok) + kSurplus);
    EXPECT_GT(coverage.of_95, 0.95 - monte_carlo_error(0.95, coverage.ok));
    EXPECT_LT(coverage.of_95, 0.95 + monte_carlo_error(0.95, coverage.ok) + kSurplus);
    EXPECT_NEAR(coverage.before_median, 0.5, monte_carlo_error(0.5, coverage.ok));
    // Asked for the true date, the failure probability is uniform over histories: its mean is one half.
    EXPECT_NEAR(coverage.mean_failure_probability, 0.5, monte_carlo_error(0.5, coverage.ok));
  }
}

INSTANTIATE_TEST_SUITE_P(StraightLives, CoverageTest,
                         testing::Values(Case{24, 0.003, 0.002, 0.002, 60, "far_precise"},
                                         Case{36, 0.003, 0.002, 0.002, 12, "near_precise"},
                                         Case{36, 0.003, 0.010, 0.010, 60, "far_noisy"},
                                         Case{48, 0.003, 0.030, 0.030, 60, "far_very_noisy"},
                                         Case{48, 0.001, 0.010, 0.010, 100, "slow_noisy"}),
                         [](const testing::TestParamInfo<Case>& one) { return std::string(one.param.name); });

// The plain regression of t on theta, which takes theta for exact, would put every one of these ends of life too early.
TEST(Coverage, NoisyEstimatesDoNotPullTheEndOfLifeTowardsNow) {
  const Case noisy{48, 0.003, 0.030, 0.030, 60, ""};
  const Coverage coverage = run(noisy, 1500, DegradationTime::months);
  EXPECT_NEAR(coverage.before_median, 0.5, monte_carlo_error(0.5, coverage.ok));
}

}  // namespace
}  // namespace sealwatch::forecast
