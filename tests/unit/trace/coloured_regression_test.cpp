// Regression with coloured noise: coefficients and standard errors against many seeds, and false alarms of the tests.
#include "sealwatch/trace/coloured_regression.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "sealwatch/trace/smooth_course.hpp"

namespace sealwatch::trace {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd autoregressive(const std::vector<double>& coefficients, Index n, unsigned seed) {
  constexpr Index kWarmUp = 500;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  VectorXd x = VectorXd::Zero(n + kWarmUp);
  for (Index t = static_cast<Index>(coefficients.size()); t < x.size(); ++t) {
    x(t) = normal(random);
    for (std::size_t k = 0; k < coefficients.size(); ++k) x(t) += coefficients[k] * x(t - static_cast<Index>(k) - 1);
  }
  return x.tail(n);
}

TEST(Burg, FindsTheCoefficientsAndTheOrder) {
  const std::vector<double> truth = {1.5, -0.7};
  const VectorXd x = autoregressive(truth, 20000, 1);
  const std::span<const double> values(x.data(), static_cast<std::size_t>(x.size()));
  const std::vector<double> found = burg(values, 2);
  constexpr double kFiveErrors = 5.0 * 0.005;  // standard error sqrt((1 - 0.49) / 20000)
  EXPECT_NEAR(found[0], truth[0], kFiveErrors);
  EXPECT_NEAR(found[1], truth[1], kFiveErrors);
  EXPECT_EQ(choose_order(values, 20), 2U);
  EXPECT_EQ(choose_order(std::vector<double>(100, 0.0), 20), 0U);
}

TEST(ColouredRegression, StandardErrorsAreThoseOfManySeeds) {
  constexpr Index kSamples = 1000;
  constexpr int kSeeds = 200;
  MatrixXd X(kSamples, 2);
  for (Index t = 0; t < kSamples; ++t) {
    X(t, 0) = 1.0;
    X(t, 1) = std::sin(2.0 * std::numbers::pi * static_cast<double>(t) / 400.0);
  }
  VectorXd squares = VectorXd::Zero(2);
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    const VectorXd y = X * VectorXd{{2.0, -1.0}} + autoregressive({0.9}, kSamples, seed);
    const ColouredFit fit = fit_coloured(y, X, 1, 1, 0.0);
    for (Index k = 0; k < 2; ++k)
      squares(k) += std::pow((fit.beta(k) - (k == 0 ? 2.0 : -1.0)), 2) / fit.covariance(k, k) / kSeeds;
  }
  constexpr double kSpread = 0.35;  // of a chi-squared of 200 over its mean, three and a half deviations
  EXPECT_NEAR(squares(0), 1.0, kSpread);
  EXPECT_NEAR(squares(1), 1.0, kSpread);
}

TEST(ColouredRegression, EffectiveSamplesAreThoseOfAMean) {
  const VectorXd noise = autoregressive({0.9}, 50000, 7);
  // (1 - rho) / (1 + rho) of an AR(1); its estimate is good to a few percent here.
  EXPECT_NEAR(effective_samples(noise, burg({noise.data(), 50000}, 1)) / 50000.0, 0.1 / 1.9, 0.005);
  EXPECT_EQ(effective_samples(VectorXd::Zero(100), {}), 100.0);
}

TEST(ColouredRegression, NoWindowReachesOverAGap) {
  EXPECT_EQ(whole_windows(8, 2, {}), (std::vector<Index>{2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(whole_windows(8, 2, {4}), (std::vector<Index>{2, 3, 6, 7}));
  EXPECT_EQ(whole_windows(8, 2, {3, 4}), (std::vector<Index>{2, 6, 7}));
  EXPECT_EQ(joints_within({3, 4, 7}, 3, 4), (Joints{1}));
  VectorXd steps(6);
  steps << 1, 2, 3, 101, 102, 103;
  EXPECT_EQ(whitened(steps, {1.0}, 1, {3}), VectorXd::Ones(4));
}

TEST(ColouredRegression, AColumnThatSaysNothingNewDoesNoHarm) {
  MatrixXd X(100, 3);
  X.col(0).setOnes();
  X.col(1).setLinSpaced(0.0, 1.0);
  X.col(2) = X.col(0) + X.col(1);
  const ColouredFit fit = fit_coloured(X.col(1) * 3.0, X, 0, 0, 1e-20);
  EXPECT_NEAR(fit.residual.norm(), 0.0, 1e-9);
  EXPECT_TRUE(fit.covariance.allFinite());
}

TEST(Course, GoesThroughItsSamplesAndKnowsItsSlope) {
  std::vector<double> t, x;
  for (int k = 0; k <= 100; ++k) t.push_back(0.01 * k), x.push_back(std::sin(6.0 * t.back()));
  const Course course(t, x);
  EXPECT_EQ(course.at(0.5).first, x[50]);
  EXPECT_NEAR(course.at(0.505).first, std::sin(6.0 * 0.505), 1e-5);  // third order in 0.06
  EXPECT_NEAR(course.at(0.505).second, 6.0 * std::cos(6.0 * 0.505), 1e-2);
  EXPECT_EQ(course.at(-1.0).first, x.front());
  EXPECT_EQ(course.at(9.0).first, x.back());
}

TEST(SmoothCourse, TakesAsManySamplesAsTheNoiseNeeds) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, 1e-3);
  VectorXd ramp(2000);
  for (Index t = 0; t < ramp.size(); ++t) ramp(t) = 0.001 * static_cast<double>(t) + normal(random);
  const VectorXd slope = smooth_course(ramp, 0.01).slope;
  EXPECT_NEAR(slope(1000), 0.1, 0.03);
  EXPECT_LT((slope.array() - 0.1).matrix().norm() / std::sqrt(2000.0), 0.015);
}

}  // namespace
}  // namespace sealwatch::trace
