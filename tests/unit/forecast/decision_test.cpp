// Expected costs and safety figures against numbers computed by hand.
#include "sealwatch/forecast/decision.hpp"

#include <gmock/gmock.h>

#include "sealwatch/forecast/safety_margin.hpp"

namespace sealwatch::forecast {
namespace {

constexpr double kRounding = 1e-9;

PredictiveDistribution uniform_10_30() { return PredictiveDistribution::make({{10.0, 0.0}, {30.0, 1.0}}).value(); }

const InterventionCosts kCosts{
    .planned = 10.0, .after_failure = 40.0, .failed_month = 2.0, .unused_month = 0.5, .months_to_vessel = 6.0};

TEST(Decision, ExpectedCostsByHand) {
  const std::vector<Candidate> candidates{{.label = "late", .months = 20.0}, {.label = "now", .months = 0.0}};
  const Decision decision = weigh_candidates(uniform_10_30(), candidates, kCosts).value();
  ASSERT_EQ(decision.rows.size(), 3u);
  EXPECT_EQ(decision.rows[0].label, "now");
  EXPECT_NEAR(decision.rows[0].expected_cost, 10.0 + 0.5 * 20.0, kRounding);
  // At 20: half have failed, 2.5 months down and 2.5 months unused in the mean.
  EXPECT_NEAR(decision.rows[1].failure_probability, 0.5, kRounding);
  EXPECT_NEAR(decision.rows[1].expected_cost, 5.0 + 20.0 + 2.0 * 2.5 + 0.5 * 2.5, kRounding);
  EXPECT_TRUE(decision.rows[2].waiting);
  EXPECT_NEAR(decision.rows[2].expected_cost, 40.0 + 2.0 * 6.0, kRounding);
  EXPECT_EQ(decision.cheapest, 0u);
}

TEST(Decision, BeforeTheEarliestFailureLaterIsCheaper) {
  const std::vector<Candidate> candidates{{.label = "now", .months = 0.0}, {.label = "at ten", .months = 10.0}};
  const Decision decision = weigh_candidates(uniform_10_30(), candidates, kCosts).value();
  EXPECT_EQ(decision.rows[decision.cheapest].label, "at ten");
  const std::vector<Candidate> dear{{.label = "now", .months = 0.0}, {.label = "at ten", .months = 10.0, .cost = 30.0}};
  EXPECT_EQ(weigh_candidates(uniform_10_30(), dear, kCosts)->cheapest, 0u);
}

// A replacement on 2031-06-01 was shown as of 2031-05-31: months give a time back within some 100 ns.
TEST(Decision, HasTheDateThatWasAskedFor) {
  const UtcTime now = parse_utc("2019-12-12").value();
  int lost = 0;
  for (const char* day : {"2020-01-01", "2021-06-01", "2023-06-01", "2030-06-01", "2031-06-01", "2032-06-01"}) {
    const UtcTime asked = parse_utc(day).value();
    const std::vector<Candidate> candidates{{.label = day, .months = months_between(now, asked)}};
    const Decision decision = weigh_candidates(uniform_10_30(), candidates, kCosts).value();
    EXPECT_EQ(decision.rows.front().date(now), asked) << day;
    lost += add_months(now, decision.rows.front().months) < asked ? 1 : 0;
  }
  EXPECT_GT(lost, 0) << "else this shows nothing";
  DecisionRow before_1970;
  before_1970.label = "now";
  EXPECT_EQ(before_1970.date({-1'499}), UtcTime{-1'000});
}

TEST(Decision, RefusesNonsense) {
  EXPECT_FALSE(weigh_candidates(uniform_10_30(), std::vector<Candidate>{{.label = "past", .months = -1.0}}, kCosts));
  EXPECT_FALSE(weigh_candidates(uniform_10_30(), {}, InterventionCosts{.after_failure = -1.0}));
  EXPECT_EQ(weigh_candidates(uniform_10_30(), {}, kCosts)->rows.size(), 1u);
}

// lambda = 1e-6 / h, C = 0.6, monthly and yearly: 0.5e-6 (0.6 730 + 0.4 8760) = 1.971e-3.
TEST(ProofTest, AverageProbabilityOfFailureOnDemand) {
  EXPECT_NEAR(*average_failure_probability_on_demand({}), 1.971e-3, 1e-9);
  ProofTesting without;
  without.partial_stroke_coverage = 0.0;
  EXPECT_NEAR(*average_failure_probability_on_demand(without), 4.38e-3, 1e-9);
  without.partial_stroke_coverage = 60.0;
  EXPECT_THAT(average_failure_probability_on_demand(without).error().describe(), testing::HasSubstr("0.6 for 60 %"));
}

TEST(ProofTest, DueAndOverdue) {
  const UtcTime start = parse_utc("2020-01-01").value();
  const TestDue due = next_test_due(add_months(start, 5.0), start, 1.0, add_months(start, 6.5));
  EXPECT_EQ(due.due, add_months(add_months(start, 5.0), 1.0));
  EXPECT_NEAR(due.overdue_months, 0.5, 1e-6);
  EXPECT_EQ(next_test_due(std::nullopt, start, 1.0, start).overdue_months, 0.0);
}

// The dissertation: at 60 % of the modulus about 28 % of the inlet flow passes the gap at nominal load.
TEST(ClosingMargin, OfAFailedAndANewSeal) {
  const ClosingMargin failed = closing_margin(4.64e12, {}).value();
  const double full_flow_s = 5.89e-3 * 0.080 / 7.85e-6;
  EXPECT_NEAR(*failed.closing_time_s, full_flow_s / (1.0 - 0.28), 0.3);
  EXPECT_LT(failed.time_margin, 0.0);
  EXPECT_NEAR(failed.force_margin, 5.89e-3 * 2.1e7 / 6.0e4 - 1.0, 1e-9);  // the relief valve limits it, not the leak
  const ClosingMargin fresh = closing_margin(2.6e13, {}).value();
  EXPECT_LT(*fresh.closing_time_s, *failed.closing_time_s);
  EXPECT_GT(fresh.time_margin, failed.time_margin);
}

TEST(ClosingMargin, ALeakThatTakesAllTheFlow) {
  const ClosingMargin margin = closing_margin(1.0e12, {}).value();
  EXPECT_FALSE(margin.closing_time_s);
  EXPECT_EQ(margin.time_margin, -1.0);
  EXPECT_LT(margin.force_margin, 0.0);
  EXPECT_FALSE(closing_margin(-1.0, {}));
}

}  // namespace
}  // namespace sealwatch::forecast
