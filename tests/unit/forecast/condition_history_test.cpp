// Isolated outliers: marked alone, believed in pairs.
#include "sealwatch/forecast/condition_history.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/forecast/lives.hpp"

namespace sealwatch::forecast {
namespace {

using test::straight_life;
using test::with_noise;

std::vector<ConditionSample> noisy_life(int tests) {
  std::mt19937_64 random(11);
  return with_noise(straight_life(tests, 0.003, 0.002), 0.002, random);
}

TEST(IsolatedOutliers, OneBadMonthIsMarkedAndNoOther) {
  auto life = noisy_life(40);
  life[20].condition += 0.05;
  const auto outlier = isolated_outliers(life);
  EXPECT_EQ(std::count(outlier.begin(), outlier.end(), true), 1);
  EXPECT_TRUE(outlier[20]);
}

TEST(IsolatedOutliers, TheLatestMonthWaitsForTheNextToConfirmIt) {
  auto life = noisy_life(41);
  life[39].condition -= 0.05;
  life[40].condition -= 0.05;
  EXPECT_TRUE(isolated_outliers(std::span(life).first(40)).back());
  const auto outlier = isolated_outliers(life);
  EXPECT_FALSE(outlier[39]);
  EXPECT_FALSE(outlier[40]);
}

TEST(IsolatedOutliers, OppositeSidesDoNotConfirmEachOther) {
  auto life = noisy_life(40);
  life[20].condition += 0.06;
  life[21].condition -= 0.06;
  const auto outlier = isolated_outliers(life);
  EXPECT_TRUE(outlier[20]);
  EXPECT_TRUE(outlier[21]);
}

TEST(IsolatedOutliers, HealthyLivesLoseNothing) {
  std::mt19937_64 random(5);
  std::size_t marked = 0;
  std::size_t judged = 0;
  for (int life = 0; life < 50; ++life) {
    const auto outlier = isolated_outliers(with_noise(straight_life(100, 0.003, 0.002), 0.002, random));
    marked += static_cast<std::size_t>(std::count(outlier.begin(), outlier.end(), true));
    judged += outlier.size();
  }
  EXPECT_LT(static_cast<double>(marked), 0.005 * static_cast<double>(judged));  // as the header promises
}

TEST(IsolatedOutliers, FewTestsAreNotJudged) {
  auto life = noisy_life(6);
  life[3].condition += 0.3;
  EXPECT_EQ(isolated_outliers(life), std::vector<bool>(6, false));
  EXPECT_TRUE(isolated_outliers({}).empty());
}

}  // namespace
}  // namespace sealwatch::forecast
