// The degradation line against a regression worked by hand, and Student's t against its table.
#include "sealwatch/forecast/degradation_line.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sealwatch/forecast/student_t.hpp"

namespace sealwatch::forecast {
namespace {

constexpr double kTable = 5e-4;      // printed tables have three decimals
constexpr double kRounding = 1e-12;  // a handful of double operations

TEST(StudentT, QuantilesOfTheTable) {
  EXPECT_NEAR(student_t_quantile(0.975, 3), 3.182, kTable);
  EXPECT_NEAR(student_t_quantile(0.90, 34), 1.307, kTable);
  EXPECT_NEAR(student_t_quantile(0.025, 22), -2.074, kTable);
  EXPECT_NEAR(student_t_probability(2.776, 4), 0.975, kTable);
}

// y = 1..5, theta = 0.90 0.88 0.87 0.83 0.82:
//   means 3 and 0.86; S_yy = 10; sum of products -0.21; b = -0.021
//   residuals -0.002 -0.001 0.010 -0.009 0.002; squares sum to 1.90e-4; sigma^2 = 1.90e-4 / 3
const std::vector<LinePoint> kByHand{{1, 0.90, 0}, {2, 0.88, 0}, {3, 0.87, 0}, {4, 0.83, 0}, {5, 0.82, 0}};

TEST(DegradationLine, RegressionByHand) {
  const auto line = fit_degradation_line(kByHand);
  ASSERT_TRUE(line);
  EXPECT_NEAR(line->mean_condition, 0.86, kRounding);
  EXPECT_NEAR(line->slope, -0.021, kRounding);
  EXPECT_NEAR(line->scatter_variance, 1.90e-4 / 3.0, kRounding);
  EXPECT_NEAR(line->slope_std(), std::sqrt(1.90e-5 / 3.0), kRounding);
  EXPECT_NEAR(*line->crossing_quantile(0.60, 0.5), 3.0 + 0.26 / 0.021, 1e-9);
}

// Interval by hand for exact dates and no measuring error known: all scatter is the seal's own, so A = sigma^2 (1 +
// 1/5).
//   T = t_{0.9,3} = 1.637744; c = sigma^2 / 10 = 6.33333e-6; T^2 c = 1.69875e-5; b^2 - T^2 c = 4.240125e-4
//   root = sqrt(7.6e-5 * 4.240125e-4 + 6.33333e-6 * 0.0676) = 6.78427e-4
//   Y_10, Y_90 = 3 + (0.00546 -+ 1.637744 * 6.78427e-4) / 4.240125e-4
TEST(DegradationLine, IntervalByHand) {
  const auto line = fit_degradation_line(kByHand);
  ASSERT_TRUE(line);
  constexpr double kSixDigits = 1e-3;  // the figures above are rounded to six digits
  EXPECT_NEAR(*line->crossing_quantile(0.60, 0.10), 13.25655, kSixDigits);
  EXPECT_NEAR(*line->crossing_quantile(0.60, 0.90), 18.49743, kSixDigits);
}

TEST(DegradationLine, ProbabilityIsTheInverseOfTheQuantile) {
  for (const double slope_drift : {0.0, 0.1}) {
    const auto line = fit_degradation_line(kByHand, slope_drift, 5.0);
    for (const double p : {0.025, 0.1, 0.5, 0.9, 0.975})
      EXPECT_NEAR(line->crossing_probability(0.60, *line->crossing_quantile(0.60, p)), p, 1e-9);
  }
}

TEST(DegradationLine, MeasuringErrorMovesNoSealButBoundsTheScatter) {
  std::vector<LinePoint> points = kByHand;
  for (LinePoint& point : points) point.condition_std = 0.005;  // 2.5e-5 of the 6.33e-5 seen
  const auto line = fit_degradation_line(points, 0.0);
  EXPECT_NEAR(line->irregularity_variance, 1.90e-4 / 3.0 - 2.5e-5, kRounding);
  for (LinePoint& point : points) point.condition_std = 0.02;  // more than the scatter seen: PEM is believed
  const auto wide = fit_degradation_line(points, 0.0);
  EXPECT_NEAR(wide->scatter_variance, 4e-4, kRounding);
  EXPECT_EQ(wide->irregularity_variance, 0.0);
}

TEST(DegradationLine, NoQuantileWhereTheSlopeMayBeZero) {
  const std::vector<LinePoint> noisy{{1, 0.90, 0}, {2, 0.80, 0}, {3, 0.95, 0}, {4, 0.82, 0}, {5, 0.87, 0}};
  const auto line = fit_degradation_line(noisy);
  ASSERT_TRUE(line);
  EXPECT_GT(line->no_fall_probability(), 0.1);
  EXPECT_FALSE(line->crossing_quantile(0.60, 0.975));
}

TEST(DegradationLine, NeedsThreeTestsAtMoreThanOneTime) {
  EXPECT_FALSE(fit_degradation_line(std::span(kByHand).first(2), 0.0));
  EXPECT_FALSE(fit_degradation_line(std::vector<LinePoint>(5, {2.0, 0.8, 0.0}), 0.0));
}

TEST(DegradationLine, RisingConditionNeverCrosses) {
  const std::vector<LinePoint> rising{{1, 0.80, 0}, {2, 0.82, 0}, {3, 0.83, 0}, {4, 0.86, 0}};
  EXPECT_FALSE(fit_degradation_line(rising, 0.0)->crossing_quantile(0.60, 0.5));
}

}  // namespace
}  // namespace sealwatch::forecast
