#include "services/advisory_generation/safety_book.hpp"

#include <gmock/gmock.h>

namespace sealwatch::advisory_generation {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

struct Case {
  RemainingLife life;
  HealthReport health;
  StateReport state;
  LeakageEstimate leakage;
  AssetConfig asset;
  Case() {
    life.header.event_time_known = true;
    life.header.event_time_ns = parse_utc("2012-03-01").value().nanoseconds;
    leakage.estimated = true;
    leakage.resistance_Pa_s_m3 = 2.6e13;
    asset.parameters = {{"A_C", {5.89e-3, 0, 1, false}}, {"x_C", {0.08, 0, 1, false}}, {"phi", {6e4, 0, 1e6, false}}};
  }
  [[nodiscard]] SafetyBook book(const std::optional<SiteSafety>& safety) const {
    return safety_book({life, health, state, leakage}, &asset, safety);
  }
};

TEST(SafetyBook, FailureOnDemandFollowsFromRateCoverageAndIntervals) {
  Case one;
  one.asset.pst.interval_months = 1.0;
  const SafetyBook book = one.book(SiteSafety{.dangerous_undetected_per_hour = 2e-6,
                                              .partial_stroke_coverage = 0.7,
                                              .full_stroke_interval_months = 12.0,
                                              .last_full_stroke = {}});
  ASSERT_TRUE(book.failure_probability_known);
  // 1/2 lambda (C T_PST + (1 - C) T_FST), a month being 730.5 h
  EXPECT_NEAR(book.failure_probability_on_demand, 0.5 * 2e-6 * (0.7 * 730.5 + 0.3 * 8766.0), 1e-12);
  EXPECT_FALSE(book.full_stroke_known);
  ASSERT_TRUE(book.partial_stroke_known);
  EXPECT_EQ(format_utc({book.partial_stroke_due_ns}), "2012-03-31T10:29:06Z") << "30.436875 days on";
  one.asset.pst.interval_months = 3.0;
  EXPECT_EQ(format_utc({one.book(std::nullopt).partial_stroke_due_ns}), "2012-05-31T07:27:18Z");
}

TEST(SafetyBook, AFullStrokeTestThatIsDueIsSaid) {
  Case one;
  SiteSafety safety;
  safety.last_full_stroke = parse_utc("2011-01-01").value();
  const SafetyBook book = one.book(safety);
  ASSERT_TRUE(book.full_stroke_known);
  EXPECT_NEAR(book.full_stroke_overdue_months, 2.0, 0.05);
  EXPECT_THAT(in_words({}, book), ElementsAre(HasSubstr("on demand"), HasSubstr("was due on 2012-01-01")));
}

TEST(SafetyBook, MarginsShrinkWithTheLeak) {
  Case one;
  const SafetyBook as_new = one.book(std::nullopt);
  ASSERT_TRUE(as_new.margin_known);
  EXPECT_FALSE(as_new.failure_probability_known);
  one.leakage.resistance_Pa_s_m3 = 1.0e12;
  EXPECT_EQ(one.book(std::nullopt).closing_time_margin, -1.0) << "the leak takes all the flow";
  EXPECT_LT(one.book(std::nullopt).closing_force_margin, as_new.closing_force_margin);
  one.leakage.estimated = false;
  EXPECT_FALSE(one.book(std::nullopt).margin_known);
}

TEST(SafetyBook, TheClosingTimeThatATestMeasuredGoesBeforeWhatTheLeakSays) {
  Case one;
  one.state.judgements = {{.quantity = "closing_time", .unit = "s", .value = 60.1, .warning_limit = 63.2}};
  EXPECT_NEAR(one.book(std::nullopt).closing_time_margin, 63.2 / 60.1 - 1.0, 1e-12);
}

TEST(SafetyBook, TheCheapestOptionIsAReasonOnlyWhereCostsAreKnown) {
  DecisionOption now{.label = "now", .cost_known = true, .expected_cost = 12.0, .currency = "MNOK"};
  DecisionOption summer{
      .label = "summer 2016", .cost_known = true, .expected_cost = 10.5, .currency = "MNOK", .cheapest = true};
  DecisionOption wait{.label = "wait for failure", .cost_known = true, .expected_cost = 74.0, .currency = "MNOK"};
  EXPECT_THAT(in_words({now, summer, wait}, {}), ElementsAre(HasSubstr("summer 2016, 10.5 MNOK expected")));
  summer.cheapest = false;
  EXPECT_TRUE(in_words({now, summer, wait}, {}).empty());
}

}  // namespace
}  // namespace sealwatch::advisory_generation
