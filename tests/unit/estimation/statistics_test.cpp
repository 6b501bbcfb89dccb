// Noise floor, residual tests and covariance on signals whose answers are known.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "sealwatch/estimation/covariance.hpp"
#include "sealwatch/estimation/residual_statistics.hpp"

namespace sealwatch {
namespace {

std::vector<double> white_noise(std::size_t size, double standard_deviation, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal(0.0, standard_deviation);
  std::vector<double> values(size);
  for (double& value : values) value = normal(generator);
  return values;
}

std::vector<double> coloured_noise(std::size_t size, double rho, unsigned seed) {
  std::vector<double> values = white_noise(size, 1.0, seed);
  for (std::size_t k = 1; k < size; ++k) values[k] += rho * values[k - 1];
  return values;
}

TEST(ResidualStatistics, NrmseIsHundredForPerfectAndZeroForTheMean) {
  const std::vector<double> y = {1.0, 2.0, 3.0, 4.0}, mean(4, 2.5), half = {1.75, 2.25, 2.75, 3.25};
  EXPECT_DOUBLE_EQ(nrmse_percent(y, y), 100.0);
  EXPECT_DOUBLE_EQ(nrmse_percent(y, mean), 0.0);
  EXPECT_DOUBLE_EQ(nrmse_percent(y, half), 50.0);
  EXPECT_DOUBLE_EQ(nrmse_percent(mean, y), 0.0);  // a constant recording has no course to reproduce
  // A frozen sensor: the mean of its values is not the value itself, by rounding.
  const std::vector<double> frozen(1001, 0.0123456789), moving(1001, 0.02);
  EXPECT_EQ(nrmse_percent(frozen, moving), 0.0);
}

// 500 trials at a nominal 5 %: 25 expected, standard deviation 4.9.
constexpr int kTrials = 500;
constexpr double kExpectedAlarms = 25.0, kThreeSigmas = 15.0;

TEST(ResidualStatistics, WhitenessTestHoldsItsLevelAndSeesColour) {
  int alarms = 0;
  for (unsigned seed = 0; seed < kTrials; ++seed) alarms += whiteness_p(white_noise(400, 2.0, seed)) < 0.05;
  EXPECT_NEAR(alarms, kExpectedAlarms, kThreeSigmas);
  EXPECT_LT(whiteness_p(coloured_noise(400, 0.4, 1)), 1e-6);
}

TEST(ResidualStatistics, IndependenceTestHoldsItsLevelAndSeesDependence) {
  int alarms = 0;
  const std::vector<double> input = coloured_noise(600, 0.9, 99);
  const PastInput past(input, 40);
  for (unsigned seed = 0; seed < kTrials; ++seed) alarms += past.independence_p(white_noise(600, 1.0, seed)) < 0.05;
  EXPECT_NEAR(alarms, kExpectedAlarms, kThreeSigmas);
  std::vector<double> dependent = white_noise(600, 1.0, 3);
  for (std::size_t k = 8; k < dependent.size(); ++k) dependent[k] += 0.3 * input[k - 8];
  EXPECT_LT(past.independence_p(dependent), 1e-6);
}

TEST(ResidualStatistics, DegenerateInputIsNoEvidence) {
  EXPECT_EQ(whiteness_p({}), 1.0);
  EXPECT_EQ(whiteness_p(std::vector<double>(100, 0.0)), 1.0);
  const std::vector<double> constant(100, 3.0);
  EXPECT_EQ(PastInput(constant, 20).independence_p(white_noise(100, 1.0, 1)), 1.0);
  EXPECT_EQ(PastInput({}, 20).independence_p({}), 1.0);
}

TEST(Covariance, IsTheInverseOfTheInformationWhateverTheScales) {
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Random(50, 4);
  jacobian.col(1) *= 1e-9;
  jacobian.col(2) *= 1e12;
  const Eigen::MatrixXd expected = (jacobian.transpose() * jacobian).inverse();
  const Covariance covariance = covariance_of(jacobian);
  constexpr double kRounding = 1e-6;  // the plain inverse suffers from the scales
  for (Eigen::Index j = 0; j < 4; ++j) EXPECT_NEAR(covariance.matrix(j, j) / expected(j, j), 1.0, kRounding);
}

TEST(Covariance, ShowsWhatTheDataDoNotTell) {
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Random(50, 4);
  jacobian.col(2) = 3e5 * jacobian.col(0);  // only the sum of both is seen
  const Covariance covariance = covariance_of(jacobian);
  EXPECT_EQ(covariance.identified, (std::vector<bool>{false, true, false, true}));
  EXPECT_TRUE(std::isinf(covariance.matrix(0, 0)) && std::isinf(covariance.matrix(2, 2)));
  EXPECT_TRUE(std::isfinite(covariance.matrix(1, 1)) && covariance.matrix(1, 1) > 0.0);
  jacobian.col(3).setZero();
  EXPECT_TRUE(std::isinf(covariance_of(jacobian).matrix(3, 3)));
}

TEST(Covariance, ColouredResidualsRaiseStandardErrorsAsTheoryHasIt) {
  // The mean of an AR(1) series: its variance is (1 + rho)/(1 - rho) times that of white noise of the same variance.
  constexpr double kRho = 0.8;
  constexpr Eigen::Index kSamples = 20000;
  std::vector<double> noise = coloured_noise(kSamples, kRho, 5);
  const Eigen::Map<Eigen::VectorXd> values(noise.data(), kSamples);
  const Eigen::VectorXd residual = values / std::sqrt(values.squaredNorm() / kSamples);
  Covariance covariance = covariance_of(Eigen::MatrixXd::Ones(kSamples, 1));
  const double factor = inflate_for_coloured_residuals(covariance, residual);
  constexpr double kBartlettBias = 0.15;  // of the kernel and of the sample
  EXPECT_NEAR(factor, std::sqrt((1.0 + kRho) / (1.0 - kRho)), kBartlettBias * 3.0);
  EXPECT_NEAR(covariance.matrix(0, 0), factor * factor / kSamples, 1e-12);
}

}  // namespace
}  // namespace sealwatch
