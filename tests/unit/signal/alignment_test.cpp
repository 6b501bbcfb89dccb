#include "sealwatch/signal/alignment.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <vector>

namespace sealwatch::signal {
namespace {

constexpr double kInterval_s = 0.01;
constexpr std::size_t kCount = 1000;

/// Speed of a stroke out and back.
double shape(double t) {
  return std::tanh(4.0 * (t - 2.0)) - 2.0 * std::tanh(3.0 * (t - 5.0)) + std::tanh(5.0 * (t - 8.0));
}

std::vector<double> record(double late_s, double gain, double noise_std, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<double> values;
  for (std::size_t i = 0; i < kCount; ++i)
    values.push_back(0.7 + gain * shape(kInterval_s * static_cast<double>(i) - late_s) + noise_std * normal(generator));
  return values;
}

TEST(Offset, IsFoundToAFractionOfASample) {
  const std::vector<double> reference = record(0.0, 1.0, 0.0, 1);
  for (const double late_s : {-0.5, -0.013, 0.0, 0.0042, 0.25}) {
    for (const double gain : {2.0, -0.5}) {
      const auto estimate = estimate_offset(reference, record(late_s, gain, 0.0, 1), kInterval_s, 1.0);
      ASSERT_TRUE(estimate);
      EXPECT_NEAR(estimate->offset_s, late_s, 1e-5);  // cubic interpolation of a smooth curve
      EXPECT_NEAR(estimate->gain, gain, 1e-3);
      EXPECT_GT(estimate->correlation * gain, 0.0);
    }
  }
}

TEST(Offset, ErrorBarsCover) {
  const std::vector<double> reference = record(0.0, 1.0, 0.0, 1);
  int inside = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const auto estimate = estimate_offset(reference, record(0.037, 1.0, 0.2, seed), kInterval_s, 1.0);
    ASSERT_TRUE(estimate);
    if (std::abs(estimate->offset_s - 0.037) < 1.96 * estimate->offset_std_s) ++inside;
  }
  EXPECT_NEAR(inside / 200.0, 0.95, 0.046);  // three standard errors of a share of 0.95 in 200
}

TEST(Offset, IsAbsentWhereNothingVariesOrTheSearchEnds) {
  const std::vector<double> reference = record(0.0, 1.0, 0.0, 1);
  EXPECT_FALSE(estimate_offset(reference, std::vector<double>(kCount, 3.0), kInterval_s, 1.0));
  EXPECT_FALSE(estimate_offset(reference, record(0.8, 1.0, 0.0, 1), kInterval_s, 0.2));
}

/// At 20 kHz there are 20 000 lags on either side: they are searched in two steps.
TEST(Offset, IsFoundAtAHighRateWithBoundedWork) {
  constexpr double kFast_s = 5e-5;
  const auto fast = [](double late_s, double gain) {
    std::vector<double> values;
    for (double t = 0.0; t < 10.0; t += kFast_s) values.push_back(gain * shape(t - late_s));
    return values;
  };
  const std::vector<double> reference = fast(0.0, 1.0);
  for (const double late_s : {-0.777, 0.00042, 0.5}) {
    const auto estimate = estimate_offset(reference, fast(late_s, -2.0), kFast_s, 1.0);
    ASSERT_TRUE(estimate);
    EXPECT_NEAR(estimate->offset_s, late_s, 1e-5);  // a fifth of a row
    EXPECT_NEAR(estimate->gain, -2.0, 1e-3);
  }
}

}  // namespace
}  // namespace sealwatch::signal
