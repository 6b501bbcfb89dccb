#include "services/state_detection/baseline.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "services/state_detection/schedule.hpp"

namespace sealwatch {
namespace {

TEST(Baseline, FirstThreeTestsTeachOnly) {
  Baseline baseline({6});
  EXPECT_DOUBLE_EQ(baseline.limits("q", 5.0, 1.0).advisory, 6.0);
  baseline.learn("q", 1.0);
  baseline.learn("q", 1.0);
  EXPECT_DOUBLE_EQ(baseline.limits("q", 5.0, 1.0).advisory, 6.0);
  baseline.learn("q", 1.0);
  EXPECT_DOUBLE_EQ(baseline.limits("q", 5.0, 1.0).advisory, 2.0);
}

TEST(Baseline, LimitsAreOnTheSideOfTheValue) {
  Baseline baseline({3});
  for (int k = 0; k < 3; ++k) baseline.learn("q", 10.0);
  const AlertLimits above = baseline.limits("q", 11.0, 2.0);
  EXPECT_DOUBLE_EQ(above.advisory, 12.0);
  EXPECT_DOUBLE_EQ(above.warning, 14.0);
  EXPECT_DOUBLE_EQ(above.alarm, 16.0);
  const AlertLimits below = baseline.limits("q", 9.0, 2.0);
  EXPECT_DOUBLE_EQ(below.advisory, 8.0);
  EXPECT_DOUBLE_EQ(below.alarm, 4.0);
}

TEST(Baseline, WidthIsThePredictionIntervalWhereThatIsLarger) {
  Baseline baseline({6});
  for (const double value : {9.0, 11.0, 9.0, 11.0, 9.0, 11.0}) baseline.learn("q", value);
  // mean 10, s = sqrt(6/5), t_5 = 6.869 at 99.9 % two-sided
  const double width = 6.869 * std::sqrt(6.0 / 5.0) * std::sqrt(1.0 + 1.0 / 6.0);
  EXPECT_NEAR(baseline.limits("q", 12.0, 0.1).advisory, 10.0 + width, 1e-9);
}

TEST(Baseline, LaterTestsDoNotMoveIt) {
  Baseline baseline({3});
  for (const double value : {1.0, 1.0, 1.0, 50.0, 50.0}) baseline.learn("q", value);
  EXPECT_DOUBLE_EQ(baseline.centre("q", 50.0), 1.0);
}

TEST(Schedule, NothingIsDueBeforeTheFirstTest) { EXPECT_FALSE(Schedule().overdue_from(PstSetting{}, 0.5)); }

TEST(Schedule, LatenessCountsFromTheDueDateAfterTheGrace) {
  Schedule schedule;
  const UtcTime first = *parse_utc("2031-01-10");
  schedule.tested(first);
  EXPECT_FALSE(schedule.lateness(add_months(first, 1.49), PstSetting{}, 0.5));
  const auto late = schedule.lateness(add_months(first, 2.0), PstSetting{}, 0.5);
  ASSERT_TRUE(late);
  EXPECT_NEAR(late->days, 30.44, 0.01);
  EXPECT_EQ(late->due, add_months(first, 1.0));
}

TEST(Schedule, AnOlderTestDoesNotTurnItBack) {
  Schedule schedule;
  const UtcTime later = *parse_utc("2031-05-10");
  schedule.tested(later);
  schedule.tested(*parse_utc("2031-01-10"));
  EXPECT_EQ(*schedule.overdue_from(PstSetting{}, 0.5), add_months(later, 1.5));
}

}  // namespace
}  // namespace sealwatch
