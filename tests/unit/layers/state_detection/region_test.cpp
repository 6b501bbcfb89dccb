#include "services/state_detection/region.hpp"

#include <gmock/gmock.h>

namespace sealwatch {
namespace {

using testing::ElementsAreArray;
constexpr AlertRegion N = AlertRegion::normal, A = AlertRegion::advisory, W = AlertRegion::warning,
                      X = AlertRegion::alarm;

/// Regions after each of `values`, limits 10, 20, 30.
std::vector<AlertRegion> follow(const std::vector<double>& values, const RegionOptions& options = {}) {
  RegionFilter filter(options);
  std::vector<AlertRegion> regions;
  for (const double value : values) {
    RegionJudgement judgement;
    judgement.value = value;
    judgement.advisory_limit = 10;
    judgement.warning_limit = 20;
    judgement.alarm_limit = 30;
    filter.update(judgement);
    regions.push_back(judgement.region);
  }
  return regions;
}

TEST(Region, LimitsHoldAboveOrBelow) {
  const AlertLimits above{10, 20, 30};
  const AlertLimits below{-10, -20, -30};
  EXPECT_EQ(region_of(9.9, above), N);
  EXPECT_EQ(region_of(10, above), A);
  EXPECT_EQ(region_of(25, above), W);
  EXPECT_EQ(region_of(31, above), X);
  EXPECT_EQ(region_of(-9.9, below), N);
  EXPECT_EQ(region_of(-10, below), A);
  EXPECT_EQ(region_of(-20, below), W);
  EXPECT_EQ(region_of(-99, below), X);
  EXPECT_EQ(region_of(99, below), N);
}

TEST(Region, OneOddTestChangesNothing) { EXPECT_THAT(follow({0, 99, 0, 99, 0}), ElementsAreArray({N, N, N, N, N})); }

TEST(Region, TwoInARowWorsenToTheMilder) {
  EXPECT_THAT(follow({0, 35, 15}), ElementsAreArray({N, N, A}));
  EXPECT_THAT(follow({0, 35, 25, 35, 35}), ElementsAreArray({N, N, W, W, X}));
}

TEST(Region, ThreeInARowRecoverToTheWorst) {
  EXPECT_THAT(follow({35, 35, 0, 0, 0}), ElementsAreArray({N, X, X, X, N}));
  EXPECT_THAT(follow({35, 35, 0, 15, 0, 0, 0}), ElementsAreArray({N, X, X, X, A, A, N}));
}

TEST(Region, MarginKeepsAValueAtTheLimitFromFlapping) {
  // The margin is 0.2 of the step of 10: recovery needs values below 8.
  EXPECT_THAT(follow({11, 11, 9, 9, 9, 9}), ElementsAreArray({N, A, A, A, A, A}));
  EXPECT_THAT(follow({11, 11, 7, 7, 7}), ElementsAreArray({N, A, A, A, N}));
}

TEST(Region, NoFlappingWhileWanderingAboutALimit) {
  std::vector<double> values;
  for (int k = 0; k < 60; ++k) values.push_back(k % 3 == 0 ? 9.0 : 11.0);
  const std::vector<AlertRegion> regions = follow(values);
  int changes = 0;
  for (std::size_t k = 1; k < regions.size(); ++k) changes += regions[k] != regions[k - 1];
  EXPECT_EQ(changes, 1);
}

TEST(Region, CountsTestsInTheRawRegion) {
  RegionFilter filter({});
  std::vector<int> counts;
  for (const double value : {0.0, 15.0, 15.0, 15.0, 25.0}) {
    RegionJudgement judgement{"q", Reference::limit, "", value, 10, 20, 30, N, N, 0};
    filter.update(judgement);
    counts.push_back(judgement.tests_in_raw_region);
  }
  EXPECT_THAT(counts, testing::ElementsAre(1, 1, 2, 3, 1));
}

TEST(Region, OptionsAreChecked) {
  EXPECT_TRUE(RegionOptions{}.validate());
  EXPECT_FALSE((RegionOptions{0, 3, 0.2}.validate()));
  EXPECT_FALSE((RegionOptions{2, 0, 0.2}.validate()));
  EXPECT_FALSE((RegionOptions{2, 3, 1.0}.validate()));
}

}  // namespace
}  // namespace sealwatch
