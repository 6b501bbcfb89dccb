#include "sealwatch/signal/statistics.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

namespace sealwatch::signal {
namespace {

/// AR(1) noise of standard deviation 1.
std::vector<double> noise(std::size_t count, double rho, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<double> values(count);
  double state = normal(generator);
  for (double& value : values) {
    value = state;
    state = rho * state + std::sqrt(1.0 - rho * rho) * normal(generator);
  }
  return values;
}

TEST(Statistics, QuantilesInterpolate) {
  EXPECT_DOUBLE_EQ(median({3.0, 1.0, 2.0}), 2.0);
  EXPECT_DOUBLE_EQ(median({4.0, 1.0, 2.0, 3.0}), 2.5);
  EXPECT_DOUBLE_EQ(quantile({0.0, 10.0}, 0.25), 2.5);
  EXPECT_DOUBLE_EQ(quantile({7.0}, 0.9), 7.0);
}

/// Share of 400 repetitions whose error is within 1.96 standard errors.
template <class Estimator>
double coverage(double rho, Estimator estimator) {
  int inside = 0;
  constexpr int kRepetitions = 400;
  for (unsigned seed = 0; seed < kRepetitions; ++seed) {
    const Estimate estimate = estimator(noise(400, rho, seed));
    if (std::abs(estimate.value) < 1.96 * estimate.std_error) ++inside;
  }
  return inside / static_cast<double>(kRepetitions);
}

// 400 repetitions know a coverage of 0.95 to 0.011; three of these, and 0.02 for the estimated autocorrelation.
constexpr double kCoverageTolerance = 0.05;

TEST(Statistics, StandardErrorsCoverWhiteAndCorrelatedNoise) {
  const auto mean_of = [](const std::vector<double>& v) { return mean(v); };
  const auto slope_of = [](const std::vector<double>& v) { return slope(v, 0.01); };
  for (const double rho : {0.0, 0.5, 0.8}) {
    EXPECT_NEAR(coverage(rho, mean_of), 0.95, kCoverageTolerance) << "rho " << rho;
    EXPECT_NEAR(coverage(rho, slope_of), 0.95, kCoverageTolerance) << "rho " << rho;
  }
}

TEST(Statistics, SlopeOfALineIsExact) {
  std::vector<double> line;
  for (int i = 0; i < 50; ++i) line.push_back(3.0 + 0.25 * i);
  EXPECT_NEAR(slope(line, 0.5).value, 0.5, 1e-12);
}

TEST(Statistics, PreciseEstimatesWeighMore) {
  const std::vector<Estimate> estimates = {{1.0, 1.0}, {2.0, 0.5}};
  const Estimate result = weighted_mean(estimates);
  EXPECT_DOUBLE_EQ(result.value, (1.0 + 4.0 * 2.0) / 5.0);
  EXPECT_DOUBLE_EQ(result.std_error, 1.0 / std::sqrt(5.0));
}

}  // namespace
}  // namespace sealwatch::signal
