// The question behind a forecast, out of what prognosis concluded.
#include "services/cli/concluded_history.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sealwatch::cli {
namespace {

LeakageEstimate estimate(const std::string& day, double condition, const std::vector<std::string>& reasons = {}) {
  LeakageEstimate one;
  one.asset_id = "A";
  one.header.message_id = "leakage_estimate/" + day;
  one.header.event_time_known = true;
  one.header.event_time_ns = parse_utc(day).value().nanoseconds;
  one.condition = condition;
  one.condition_std = 0.001;
  one.reasons = reasons;
  one.used_for_forecast = reasons.empty();
  return one;
}

class Question : public ::testing::Test {
 protected:
  Question() {
    asset_.asset_id = "A";
    asset_.site = "field";
    asset_.condition = ConditionSetting{
        .parameter = "R_CL", .at_100 = 2.6e13, .at_60 = 4.64e12, .unit = "Pa s/m3", .part = "piston seal"};
    SiteConfig site;
    site.site = "field";
    site.booking_lead_time_months = 9.0;
    site.campaigns = {{.label = "late", .start = parse_utc("2034-06-01").value()},
                      {.label = "early", .start = parse_utc("2032-06-01").value()}};
    configuration_.sites.push_back(site);
    for (const auto& one : {estimate("2031-02-10", 0.98), estimate("2031-01-10", 0.99),
                            estimate("2031-03-10", 0.5, {"the recording was cut"})})
      history_.take(one);
  }

  AssetConfig asset_;
  Configuration configuration_;
  ConcludedHistory history_;
};

TEST_F(Question, HasTheTestsInTheOrderOfTimeAndSaysWhatWasLeftOut) {
  const auto question = history_.question(asset_, configuration_);
  ASSERT_TRUE(question);
  EXPECT_EQ(question->tests, 3U);
  ASSERT_EQ(question->request.history.size(), 2U);
  EXPECT_EQ(question->request.history.front().condition, 0.99);
  EXPECT_EQ(question->request.now, parse_utc("2031-03-10").value()) << "a test that was left out is the latest still";
  ASSERT_EQ(question->not_counted.size(), 1U);
  EXPECT_EQ(question->not_counted.front().why, "the recording was cut");
  EXPECT_EQ(question->months_to_vessel, 9.0);
  EXPECT_EQ(question->request.horizons.size(), 2U);
  EXPECT_FALSE(question->request.installed);
}

TEST_F(Question, BeginsAnewWithAReplacement) {
  RemainingLife life;
  life.asset_id = "A";
  life.replacement_known = true;
  life.replaced_ns = parse_utc("2031-01-20").value().nanoseconds;
  history_.take(life);
  const auto question = history_.question(asset_, configuration_);
  ASSERT_TRUE(question);
  EXPECT_EQ(question->tests, 2U);
  EXPECT_EQ(question->request.installed, UtcTime{life.replaced_ns});
  EXPECT_EQ(question->first, parse_utc("2031-02-10").value());
}

TEST_F(Question, HasNoTestAfterAReplacementThatNoneHasFollowed) {
  RemainingLife life;  // of a maintenance_event: of no test
  life.asset_id = "A";
  life.replacement_known = true;
  for (const char* day : {"2031-04-01", "2031-01-20"}) {
    life.replaced_ns = parse_utc(day).value().nanoseconds;
    history_.take(life);
  }
  const auto question = history_.question(asset_, configuration_);
  ASSERT_TRUE(question);
  EXPECT_EQ(question->tests, 0U);
  EXPECT_TRUE(question->request.history.empty());
  EXPECT_EQ(history_words(*question), "replaced on 2031-04-01, no test since") << "the latest of all counts";
}

/// The answer of prognosis to an act.
RemainingLife answer(const std::string& act) {
  RemainingLife life;
  life.asset_id = "A";
  life.header.message_id = "remaining_life/" + act;
  life.header.source_ids = {act};
  return life;
}

TEST_F(Question, LeavesOutWhatWasRetracted) {
  LeakageEstimate wrong = estimate("2032-03-10", 0.3);
  wrong.header.pst_id = "wrong";
  history_.take(wrong);
  const std::string act = "retraction/A/test/wrong/2031-03-11T00:00:00Z";
  RemainingLife of_wrong;
  of_wrong.header.pst_id = "wrong";
  history_.take(of_wrong);
  history_.take(answer(act));
  const auto question = history_.question(asset_, configuration_);
  ASSERT_TRUE(question);
  EXPECT_EQ(question->tests, 3U);
  EXPECT_EQ(question->request.now, parse_utc("2031-03-10").value());

  history_.take(answer("retraction/A/withdrawn/2031-03-12T00:00:00Z/" + act));
  EXPECT_EQ(history_.question(asset_, configuration_)->tests, 4U);
}

TEST_F(Question, IsNoneWhereAllTestsAreRetracted) {
  history_.take(answer("retraction/A/since/2030-01-01T00:00:00Z/2031-03-11T00:00:00Z"));
  EXPECT_FALSE(history_.question(asset_, configuration_));
}

TEST_F(Question, HasAReplacementThatWasTakenBackAndReportedAgain) {
  RemainingLife life = answer("maintenance_event/A/seal_replaced/2031-03-11T00:00:00Z/2031-01-20T00:00:00Z");
  life.replacement_known = true;
  life.replaced_ns = parse_utc("2031-01-20").value().nanoseconds;
  history_.take(life);
  history_.take(answer("retraction/A/withdrawn/2031-03-12T00:00:00Z/" + life.header.source_ids.front()));
  EXPECT_FALSE(history_.question(asset_, configuration_)->request.installed);
  life.header.source_ids.front() = "maintenance_event/A/seal_replaced/2031-03-13T00:00:00Z/2031-01-20T00:00:00Z";
  history_.take(life);
  EXPECT_EQ(history_.question(asset_, configuration_)->request.installed, UtcTime{life.replaced_ns});
}

Advisory advice(const std::string& day, const std::string& recommendation) {
  Advisory one;
  one.asset_id = "A";
  one.header.event_time_ns = parse_utc(day).value().nanoseconds;
  one.recommendation = recommendation;
  return one;
}

TEST_F(Question, HasTheAdviceThatIsInForce) {
  history_.take(advice("2031-03-10", "of the last test"));
  history_.take(advice("2031-02-10", "of a test that came late"));
  Advisory old = advice("2031-03-11", "superseded");
  old.state = AdvisoryState::superseded;
  history_.take(old);
  ASSERT_TRUE(history_.question(asset_, configuration_)->advice);
  EXPECT_EQ(history_.question(asset_, configuration_)->advice->recommendation, "of the last test");

  RemainingLife life;  // replaced since: what was advised before is of another seal
  life.asset_id = "A";
  life.replacement_known = true;
  life.replaced_ns = parse_utc("2031-04-01").value().nanoseconds;
  history_.take(life);
  EXPECT_FALSE(history_.question(asset_, configuration_)->advice);
}

TEST_F(Question, IsNoneWithoutASealOrATest) {
  EXPECT_FALSE(ConcludedHistory().question(asset_, configuration_));
  asset_.condition.reset();
  EXPECT_FALSE(history_.question(asset_, configuration_));
}

}  // namespace
}  // namespace sealwatch::cli
