#include "sealwatch/forecast/degradation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace sealwatch::forecast {
namespace {

TEST(Degradation, FollowsTheRecursion) {
  // With ranges of no width the recursion is deterministic but for Gamma, which is set to zero.
  const DegradationSetting setting{.initial_condition = 1.0,
                                   .n_0 = 1.0,
                                   .initial_gamma = {0.03, 0.03},
                                   .steepening_limit = {0.0, 0.0},
                                   .irregularity = {0.01, 0.01}};
  Degradation seal(1, setting);
  for (int n = 1; n <= 50; ++n) seal.advance();
  EXPECT_EQ(seal.month(), 50);
  EXPECT_NEAR(seal.condition(), 1.0 - 0.04 * std::log(51.0), 1e-12);  // the logarithms telescope
}

TEST(Degradation, SteepensByHalfTheLimitAMonthInTheMean) {
  const DegradationSetting setting{
      .initial_gamma = {0.0, 0.0}, .steepening_limit = {0.002, 0.002}, .irregularity = {0.0, 0.0}};
  double expected = 1.0;
  for (int n = 1; n <= 100; ++n) expected -= 0.001 * n * std::log((n + 1.0) / n);
  double sum = 0.0;
  constexpr int kLives = 400;
  for (int seed = 0; seed < kLives; ++seed) {
    Degradation seal(seed, setting);
    for (int n = 1; n <= 100; ++n) seal.advance();
    sum += seal.condition();
  }
  // One life scatters by 0.0006 sqrt(sum of squared remaining logarithms), below 0.005: the mean of 400 by 0.00025.
  EXPECT_NEAR(sum / kLives, expected, 0.001);
}

TEST(Degradation, SameSeedSameLifeAndOthersDiffer) {
  Degradation a(7), b(7), c(8);
  for (int n = 1; n <= 60; ++n) EXPECT_EQ(a.advance(), b.advance());
  for (int n = 1; n <= 60; ++n) c.advance();
  EXPECT_NE(a.condition(), c.condition());
}

TEST(Degradation, RandomNumbersAreThoseOfTheStandardEngine) {
  // The 10000th number of a default-seeded mt19937_64 is fixed by the C++ standard.
  UniformRandom random(5489U);
  double last = 0.0;
  for (int k = 0; k < 10000; ++k) last = random.unit();
  EXPECT_EQ(last, static_cast<double>(9981545732273789042ULL >> 11U) * 0x1p-53);
}

TEST(Degradation, NineSealsOfTenFailBetween8And20Years) {
  constexpr int kLives = 1000;
  std::vector<int> failures;
  for (int seed = 0; seed < kLives; ++seed) {
    Degradation seal(seed);
    while (seal.advance() > 0.60) ASSERT_LT(seal.month(), 1000);
    failures.push_back(seal.month());
  }
  std::sort(failures.begin(), failures.end());
  const auto within =
      std::count_if(failures.begin(), failures.end(), [](int month) { return month >= 96 && month <= 240; });
  EXPECT_GT(within, 900);
  EXPECT_NEAR(failures[kLives / 2], 13 * 12, 12);
}

}  // namespace
}  // namespace sealwatch::forecast
