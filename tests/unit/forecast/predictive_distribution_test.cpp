#include "sealwatch/forecast/predictive_distribution.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "sealwatch/forecast/normal.hpp"
#include "sealwatch/forecast/proper_scores.hpp"

namespace sealwatch::forecast {
namespace {

constexpr double kRounding = 1e-12;

PredictiveDistribution of(std::vector<PredictiveDistribution::Point> points) {
  return PredictiveDistribution::make(std::move(points)).value();
}

/// Uniform between 10 and 30 months.
PredictiveDistribution uniform() { return of({{10.0, 0.0}, {30.0, 1.0}}); }

TEST(PredictiveDistribution, QuantileTurnsTheProbabilityRound) {
  EXPECT_NEAR(uniform().cdf(15.0), 0.25, kRounding);
  EXPECT_NEAR(uniform().quantile(0.25), 15.0, kRounding);
  EXPECT_EQ(uniform().cdf(5.0), 0.0);
  EXPECT_EQ(uniform().cdf(40.0), 1.0);
  EXPECT_NEAR(uniform().mean(), 20.0, kRounding);
  const auto quantiles = uniform().reported_quantiles();
  EXPECT_NEAR(quantiles.front(), 10.5, kRounding);
  EXPECT_NEAR(quantiles[4], 20.0, kRounding);
  EXPECT_NEAR(quantiles.back(), 29.5, kRounding);
}

// CRPS of U(a, b) at y within: with z = (y - a)/(b - a), (b - a) (z^2 - z + 1/3).
TEST(PredictiveDistribution, CrpsOfTheUniformDistribution) {
  for (const double y : {10.0, 14.0, 20.0, 30.0}) {
    const double z = (y - 10.0) / 20.0;
    EXPECT_NEAR(uniform().crps(y), 20.0 * (z * z - z + 1.0 / 3.0), kRounding);
  }
  EXPECT_NEAR(uniform().crps(5.0), 5.0 + 20.0 / 3.0, kRounding);
  EXPECT_NEAR(uniform().crps(35.0), 5.0 + 20.0 / 3.0, kRounding);
}

TEST(PredictiveDistribution, CrpsOfAPointIsTheAbsoluteError) {
  const auto point = of({{12.0, 1.0}});
  EXPECT_NEAR(point.crps(15.0), 3.0, kRounding);
  EXPECT_NEAR(point.crps(7.0), 5.0, kRounding);
}

TEST(PredictiveDistribution, CrpsOfAFineTableIsThatOfTheNormalDistribution) {
  std::vector<PredictiveDistribution::Point> points;
  for (double t = 20.0; t <= 80.0; t += 0.05) points.push_back({t, normal_probability((t - 50.0) / 5.0)});
  const auto table = of(points);
  for (const double y : {40.0, 50.0, 57.0}) EXPECT_NEAR(table.crps(y), normal_crps(50.0, 5.0, y), 1e-4);
}

TEST(PredictiveDistribution, MonthsFailedAreTheIntegralOfTheProbability) {
  EXPECT_NEAR(uniform().expected_months_failed_before(30.0), 10.0, kRounding);
  EXPECT_NEAR(uniform().expected_months_failed_before(20.0), 2.5, kRounding);
  EXPECT_NEAR(uniform().expected_months_failed_before(35.0), 15.0, kRounding);
  EXPECT_EQ(uniform().expected_months_failed_before(9.0), 0.0);
}

TEST(PredictiveDistribution, PoolIsTheWeightedMean) {
  const auto other = of({{20.0, 0.0}, {40.0, 1.0}});
  const std::vector<PredictiveDistribution> members{uniform(), other};
  const auto pooled = pool(members, std::vector<double>{3.0, 1.0}).value();
  for (double t = 5.0; t <= 45.0; t += 1.7)
    EXPECT_NEAR(pooled.cdf(t), 0.75 * uniform().cdf(t) + 0.25 * other.cdf(t), kRounding) << t;
  EXPECT_FALSE(pool(members, std::vector<double>{1.0}));
  EXPECT_FALSE(pool(members, std::vector<double>{0.0, 0.0}));
  EXPECT_FALSE(pool({}, {}));
}

TEST(PredictiveDistribution, RefusesWhatIsNoDistribution) {
  EXPECT_FALSE(PredictiveDistribution::make({}));
  EXPECT_FALSE(PredictiveDistribution::make({{10.0, 0.5}, {5.0, 0.7}}));
  EXPECT_FALSE(PredictiveDistribution::make({{10.0, 0.5}, {15.0, 0.4}}));
  EXPECT_FALSE(PredictiveDistribution::make({{-1.0, 0.5}}));
  EXPECT_FALSE(PredictiveDistribution::make({{1.0, 1.5}}));
  EXPECT_FALSE(PredictiveDistribution::make({{std::nan(""), 0.5}}));
}

TEST(ProperScores, IntervalScoreIsWidthPlusPenalty) {
  EXPECT_EQ(interval_score(10.0, 20.0, 0.8, 15.0), 10.0);
  EXPECT_NEAR(interval_score(10.0, 20.0, 0.8, 23.0), 10.0 + 10.0 * 3.0, 1e-9);
  EXPECT_NEAR(interval_score(10.0, 20.0, 0.95, 9.0), 10.0 + 40.0, 1e-9);
}

// Tables of the beta distribution: 85 of 100 at 95 %.
TEST(ProperScores, ClopperPearson) {
  const Interval interval = clopper_pearson(85, 100).value();
  EXPECT_NEAR(interval.low, 0.7647, 1e-4);
  EXPECT_NEAR(interval.high, 0.9135, 1e-4);
  EXPECT_EQ(clopper_pearson(0, 10)->low, 0.0);
  EXPECT_NEAR(clopper_pearson(0, 10)->high, 0.3085, 1e-4);  // 1 - 0.025^(1/10)
  EXPECT_EQ(clopper_pearson(10, 10)->high, 1.0);
  EXPECT_FALSE(clopper_pearson(3, 2));
  EXPECT_FALSE(clopper_pearson(0, 0));
}

// Lives of equal length: the ratio estimator is the standard error of the means of the lives.
TEST(ProperScores, ForecastsOfOneLifeAreOneCluster) {
  const std::vector<Cluster> lives{{.sum = 10.0, .count = 10}, {.sum = 0.0, .count = 10}, {.sum = 5.0, .count = 10}};
  const ClusteredMean mean = clustered_mean(lives).value();
  EXPECT_NEAR(mean.mean, 0.5, kRounding);
  EXPECT_NEAR(mean.standard_error, 0.5 / std::sqrt(3.0), kRounding);
  EXPECT_EQ(mean.values, 30);
  EXPECT_FALSE(clustered_mean(std::vector<Cluster>{{1.0, 1}}));
}

TEST(ProperScores, HistogramCountsEveryValueOnce) {
  EXPECT_THAT(histogram(std::vector<double>{0.0, 0.05, 0.5, 0.95, 1.0}, 10),
              testing::ElementsAre(2, 0, 0, 0, 0, 1, 0, 0, 0, 2));
}

}  // namespace
}  // namespace sealwatch::forecast
