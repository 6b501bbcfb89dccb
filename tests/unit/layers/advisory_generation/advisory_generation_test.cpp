// The advice layer by its contract: joins, deaths, superseding chains, acknowledgements, replacements, overdue tests.
#include "services/advisory_generation/advisory_generation.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <set>

#include "tests/unit/layers/advisory_generation/fixtures.hpp"
#include "tests/unit/layers/prognostic_assessment/layer_contract.hpp"

namespace sealwatch::advisory_generation {
namespace {

using namespace sealwatch::test;
using testing::Contains;
using testing::HasSubstr;

class AdvisoryGenerationTest : public testing::Test {
 protected:
  std::vector<Message> run(const std::vector<Message>& inputs, std::optional<std::size_t> death_after = {}) const {
    return run_layer([this] { return AdvisoryGeneration::make(configuration_).value(); }, inputs, death_after);
  }
  std::vector<Advisory> advisories(const std::vector<Message>& inputs) const { return of_kind<Advisory>(run(inputs)); }

  Configuration configuration_ = configuration();
};

Acknowledgement acknowledgement(const std::string& advisory_id, double month, const std::string& who = "A. Operator") {
  Acknowledgement seen;
  seen.asset_id = kAsset;
  seen.advisory_id = advisory_id;
  seen.acknowledged_by = who;
  seen.remark = "work order 4711";
  seen.header.message_id = "acknowledgement/" + advisory_id + "/" + std::to_string(month);
  seen.header.event_time_known = true;
  seen.header.event_time_ns = add_months(kInstalled, month).nanoseconds;
  return seen;
}

MaintenanceEvent replacement(double month) {
  MaintenanceEvent event;
  event.asset_id = kAsset;
  event.kind = "seal_replaced";
  event.reported_by = "night shift";
  event.header.event_time_known = true;
  event.header.event_time_ns = add_months(kInstalled, month).nanoseconds;
  event.header.message_id = "maintenance_event/" + kAsset + "/" + format_utc({event.header.event_time_ns});
  return event;
}

StateReport overdue(double month) {
  StateReport report;
  report.asset_id = kAsset;
  report.pst_overdue = true;
  report.overdue_days = 10.0;
  report.header.event_time_known = true;
  report.header.event_time_ns = add_months(kInstalled, month).nanoseconds;
  report.header.message_id = "state_report/" + kAsset + "/overdue/" + format_date({report.header.event_time_ns});
  return report;
}

std::string ten_days_before(double month) {
  return format_date(add_seconds(add_months(kInstalled, month), -864'000.0));
}

std::vector<Message> joined(std::vector<Message> inputs, const std::vector<Message>& more) {
  inputs.insert(inputs.end(), more.begin(), more.end());
  return inputs;
}

TEST_F(AdvisoryGenerationTest, AdvisoryLeadsDownToTheWaveform) {
  const auto all = advisories(inputs_of({{.month = 24}}));
  ASSERT_EQ(all.size(), 1u);
  const Advisory& advisory = all[0];
  EXPECT_EQ(advisory.header.message_id, "advisory/" + advisory.header.pst_id);
  EXPECT_EQ(advisory.header.producer, "advisory_generation 0.1.0");
  EXPECT_TRUE(advisory.header.replay && advisory.header.event_time_known);
  for (const char* topic : {"remaining_life/", "leakage_estimate/", "health_report/", "state_report/", "test_window/"})
    EXPECT_THAT(advisory.header.source_ids, Contains(topic + advisory.header.pst_id));
  EXPECT_EQ(advisory.action, AdvisoryAction::none);
  EXPECT_TRUE(advisory.request_for_work.empty());
  EXPECT_THAT(advisory.reasons,
              Contains(HasSubstr("forecast (ols, 36 months): 90 months left (80 %: 85 to 95 months)")));
  EXPECT_THAT(advisory.reasons, Contains(HasSubstr("failure before summer 2019")));
}

TEST_F(AdvisoryGenerationTest, ReasonsNameTheTestAndSpeakToPeople) {
  TestCase one{.month = 24, .used = false, .verdict = PstVerdict::not_judged};
  one.judgements = {{.quantity = "velocity_gain",
                     .reference = Reference::own_baseline,
                     .unit = "1",
                     .value = 1.2,
                     .advisory_limit = 1.05,
                     .warning_limit = 1.1,
                     .alarm_limit = 1.3,
                     .region = AlertRegion::warning},
                    {.quantity = "residual.pressure_a",
                     .reference = Reference::nominal_model,
                     .unit = "%",
                     .value = 310.0,
                     .advisory_limit = 50.0,
                     .warning_limit = 300.0,
                     .alarm_limit = 1000.0,
                     .region = AlertRegion::warning}};
  const Advisory advisory = advisories(inputs_of({one})).back();
  EXPECT_THAT(advisory.recommendation, testing::Not(HasSubstr("_")));
  for (std::string reason : advisory.reasons) {
    if (const auto symbol = reason.find("R_CL"); symbol != std::string::npos) reason.erase(symbol, 4);
    EXPECT_THAT(reason, testing::Not(HasSubstr("_")));
  }
  EXPECT_THAT(advisory.reasons, Contains("test of 2012-01-01 left out of the forecast: cut after 7.4 s of about 31 s"));
  EXPECT_THAT(advisory.reasons, Contains(HasSubstr("test of 2012-01-01: seal condition")));
  EXPECT_THAT(advisory.reasons, Contains(HasSubstr("partial stroke test not judged: stroke ended")));
  EXPECT_THAT(advisory.reasons, Contains("velocity gain in region warning: 1.2 (warning above 1.1, alarm above 1.3; by "
                                         "this actuator's first tests)"));
  EXPECT_THAT(
      advisory.reasons,
      Contains("difference from the simulation in pressure A in region warning: 310 % (warning above 300, alarm "
               "above 1000; by the model of the asset file)"));
}

TEST_F(AdvisoryGenerationTest, AConditionOfAnEarlierTestIsNamedSo) {
  auto tests = life_until(80, 90, 100.0);
  const auto of_last = advisories(inputs_of(tests));
  EXPECT_THAT(of_last.back().recommendation, testing::Not(HasSubstr("last test that counts")));
  tests.back().used = false;
  const auto of_earlier = advisories(inputs_of(tests));
  EXPECT_THAT(of_earlier.back().recommendation,
              HasSubstr("(limit 60.0 %) by the last test that counts, which this one does not; its end of life"));
  EXPECT_THAT(of_earlier.back().reasons,
              Contains(HasSubstr("test of " + format_date(tests.back().time()) + " left out of the forecast")));
}

TEST_F(AdvisoryGenerationTest, OrderOfTheJoinDoesNotMatter) {
  const auto tests = life_until(60, 70, 100.0);
  auto backwards = inputs_of(tests);
  for (std::size_t i = 0; i < backwards.size(); i += 4)
    std::reverse(backwards.begin() + static_cast<std::ptrdiff_t>(i),
                 backwards.begin() + static_cast<std::ptrdiff_t>(i + 4));
  EXPECT_EQ(run(backwards), run(inputs_of(tests)));
}

TEST_F(AdvisoryGenerationTest, AForgedHalfHoldsUpNothingAndAnyNumberTakesNoMoreMemory) {
  const auto life = life_until(60, 80, 100.0);
  const auto layer = AdvisoryGeneration::make(configuration_).value();
  expect_flat_under_forged_halves(*layer, life[0].messages());
  std::vector<Message> outputs;
  for (const Message& input : inputs_of(life))
    std::ranges::move(layer->receive(input).outputs, std::back_inserter(outputs));
  EXPECT_EQ(outputs, run(inputs_of(life)));
  EXPECT_EQ(layer->held(), 4U * 16U) << "those that were overtaken wait for nothing";
}

TEST_F(AdvisoryGenerationTest, ForgedAnswersToRetractionsTakeNoMoreMemory) {
  const auto layer = AdvisoryGeneration::make(configuration_).value();
  for (const Message& input : inputs_of({{.month = 24}})) (void)layer->receive(input);
  std::size_t open = 0;
  for (int k = 0; k < 10'000; ++k) {
    RemainingLife answer = TestCase{}.life();
    answer.header.pst_id.clear();
    answer.header.source_ids = {"retraction/" + kAsset + "/test/forged-" + std::to_string(k) + "/2012-01-01T00:00:00Z"};
    answer.header.message_id = "remaining_life/" + answer.header.source_ids[0];
    open += 1 - layer->receive(answer).consumed.size();
  }
  EXPECT_EQ(open, 256U);
}

TEST_F(AdvisoryGenerationTest, DeathAnywhereChangesNothing) {
  auto tests = life_until(60, 96, 100.0);
  tests[5].used = false;
  tests[8].verdict = PstVerdict::failed;
  auto inputs = inputs_of(tests);
  inputs.insert(inputs.begin() + 41, acknowledgement("recommendation/unknown", 70.2));
  inputs.insert(inputs.begin() + 100, overdue(84.5));
  inputs.insert(inputs.begin() + 120, replacement(88.5));
  std::swap(inputs[21], inputs[26]);
  const auto undisturbed = run(inputs);
  for (std::size_t death = 0; death < inputs.size(); ++death) ASSERT_EQ(run(inputs, death), undisturbed) << death;
}

TEST_F(AdvisoryGenerationTest, SupersedingChainNamesEveryPredecessor) {
  const auto all = advisories(inputs_of(life_until(30, 101, 100.0)));
  std::string open;  // advisory_id in force
  std::vector<AdvisoryAction> actions;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Advisory& advisory = all[i];
    if (advisory.state == AdvisoryState::superseded) {
      EXPECT_EQ(advisory.advisory_id, open);
      ASSERT_LT(i + 1, all.size());
      EXPECT_EQ(all[i + 1].supersedes_id, open);
      EXPECT_EQ(advisory.header.message_id, all[i + 1].header.message_id + "/superseded");
      EXPECT_EQ(all[i + 1].revision, 1);
      continue;
    }
    if (advisory.advisory_id != open) actions.push_back(advisory.action);
    open = advisory.advisory_id;
  }
  using A = AdvisoryAction;
  EXPECT_EQ(actions, (std::vector<A>{A::none, A::plan_replacement, A::book_vessel, A::book_vessel, A::replace_now}));
}

TEST_F(AdvisoryGenerationTest, WorkOrderKeepsItsIdOverAllRevisions) {
  const auto all = advisories(inputs_of(life_until(60, 101, 100.0)));
  std::size_t orders = 0;
  for (const Advisory& advisory : all)
    for (const RequestForWork& work : advisory.request_for_work) {
      ++orders;
      EXPECT_EQ(work.work_id, "work/" + kAsset + "/first seal");
      EXPECT_EQ(work.work_type, "replace actuator");
      EXPECT_EQ(work.segment, "north/XT03");
      EXPECT_TRUE(work.start_before_known);
      EXPECT_THAT(work.solution_package, HasSubstr("spare actuator (model eha)"));
    }
  EXPECT_GT(orders, 30u);
}

TEST_F(AdvisoryGenerationTest, AcknowledgementStaysUntilTheRecommendationChanges) {
  const auto before = inputs_of(life_until(60, 85, 100.0));
  const Advisory current = advisories(before).back();
  ASSERT_EQ(current.action, AdvisoryAction::book_vessel);
  const auto seen = joined(before, {acknowledgement(current.advisory_id, 85.2)});
  const Advisory answer = advisories(seen).back();
  EXPECT_EQ(answer.state, AdvisoryState::acknowledged);
  EXPECT_EQ(answer.acknowledged_by, "A. Operator");
  EXPECT_EQ(answer.acknowledgement_remark, "work order 4711");
  EXPECT_THAT(answer.header.message_id, testing::StartsWith(current.header.message_id + "/acknowledged/"));
  const auto later = advisories(joined(seen, inputs_of(life_until(86, 101, 100.0))));
  const auto next = std::find_if(later.begin(), later.end(), [](const auto& a) {
    return a.header.event_time_ns > add_months(kInstalled, 85.5).nanoseconds;
  });
  EXPECT_EQ(next->state, AdvisoryState::acknowledged);
  EXPECT_EQ(next->acknowledged_by, "A. Operator");
  EXPECT_EQ(later.back().action, AdvisoryAction::replace_now);
  EXPECT_EQ(later.back().state, AdvisoryState::active);
}

TEST_F(AdvisoryGenerationTest, TestsOfUnknownTimeThatFailGiveNoDate) {
  std::vector<TestCase> tests;
  for (int month = 1; month <= 3; ++month)
    tests.push_back({.month = static_cast<double>(month),
                     .forecast = ForecastState::insufficient_history,
                     .verdict = PstVerdict::failed,
                     .time_known = false});
  const Advisory advisory = advisories(inputs_of(tests)).back();
  EXPECT_EQ(advisory.action, AdvisoryAction::replace_now);
  EXPECT_FALSE(advisory.latest_by_known);
}

TEST_F(AdvisoryGenerationTest, AcknowledgingTwiceIsAcknowledgingOnce) {
  const auto before = inputs_of(life_until(60, 85, 100.0));
  const Advisory current = advisories(before).back();
  const auto once = run(joined(before, {acknowledgement(current.advisory_id, 85.2)}));
  EXPECT_EQ(
      run(joined(before, {acknowledgement(current.advisory_id, 85.2), acknowledgement(current.advisory_id, 85.3)})),
      once);
}

TEST_F(AdvisoryGenerationTest, UnknownAdvisoryIsNotedNotAcknowledged) {
  const auto before = inputs_of(life_until(60, 62, 100.0));
  const Advisory answer = advisories(joined(before, {acknowledgement("recommendation/other", 62.2)})).back();
  EXPECT_EQ(answer.state, AdvisoryState::active);
  EXPECT_THAT(answer.acknowledgement_remark, HasSubstr("'recommendation/other' by A. Operator not applied"));
  EXPECT_TRUE(run({acknowledgement("anything", 1.0)}).empty());  // nothing known of the asset
}

TEST_F(AdvisoryGenerationTest, WhatWasRemarkedStaysBesideAnAcknowledgementOfSomethingElse) {
  const auto before = inputs_of(life_until(60, 85, 100.0));
  const auto seen = acknowledgement(advisories(before).back().advisory_id, 85.2);
  const Advisory answer = advisories(joined(before, {seen, acknowledgement("recommendation/other", 85.3)})).back();
  EXPECT_EQ(answer.state, AdvisoryState::acknowledged);
  EXPECT_THAT(answer.acknowledgement_remark, testing::AllOf(HasSubstr("work order 4711; "), HasSubstr("not applied")));
}

// Whoever acknowledges for ever, be it a stranger, makes no message longer than the one before.
TEST_F(AdvisoryGenerationTest, AnyNumberOfAcknowledgementsMakesNoAdvisoryLonger) {
  auto inputs = inputs_of(life_until(60, 62, 100.0));
  const std::size_t before = advisories(inputs).size();
  for (int k = 0; k < 1000; ++k) inputs.push_back(acknowledgement("recommendation/other", 62.2 + 1e-4 * k));
  const auto all = advisories(inputs);
  ASSERT_EQ(all.size(), before + 1000);
  std::set<std::string> ids;
  for (const Advisory& one : all) {
    EXPECT_TRUE(ids.insert(one.header.message_id).second);
    EXPECT_LT(one.header.message_id.size(), 100u);
    EXPECT_LE(one.acknowledgement_remark.size(), 8000u);
  }
  EXPECT_EQ(of_kind<Advisory>(run(inputs, 500)), all) << "killed in between";
}

// A date far ahead, of a clock that was wrong or of a forger, must not stop the advice in silence.
TEST_F(AdvisoryGenerationTest, ALiveTestOlderThanOneThatIsKnownIsToldOf) {
  const auto layer = AdvisoryGeneration::make(configuration_).value();
  for (const Message& input : inputs_of({{.month = 24}, {.month = 300}})) (void)layer->receive(input);
  Conclusion conclusion;
  const TestCase next{.month = 25};
  for (Message input : next.messages()) {
    header_of(input).replay = false;
    conclusion = layer->receive(input);
  }
  EXPECT_TRUE(conclusion.outputs.empty());
  ASSERT_EQ(conclusion.refused.size(), 1u);
  EXPECT_THAT(conclusion.refused[0].reason, HasSubstr("the test is of " + format_utc(next.time()) +
                                                      ", and one of 2035-01-01T01:30:00Z is known: its "
                                                      "advice stands; if that date is wrong, retract it"));
}

TEST_F(AdvisoryGenerationTest, ReplacementClosesTheWorkAndStartsAnew) {
  const auto before = inputs_of(life_until(60, 100, 100.0));
  const auto all = advisories(joined(joined(before, {replacement(100.5)}),
                                     inputs_of({{.month = 101, .forecast = ForecastState::insufficient_history}})));
  const Advisory& fresh = all[all.size() - 2];
  EXPECT_EQ(all[all.size() - 3].state, AdvisoryState::superseded);
  EXPECT_EQ(fresh.action, AdvisoryAction::none);
  EXPECT_THAT(fresh.recommendation, HasSubstr("seal replaced on 2018-05"));
  EXPECT_EQ(all.back().action, AdvisoryAction::none);
  const auto next_seal =
      advisories(joined(joined(before, {replacement(100.5)}), inputs_of(life_until(150, 160, 170.0))));
  EXPECT_THAT(next_seal.back().request_for_work.at(0).work_id, HasSubstr("seal of 2018-05"));
}

// A wrong year must not cancel a vessel.
TEST_F(AdvisoryGenerationTest, AReplacementFromBeforeTheLastTestLeavesTheAdviceStanding) {
  const auto before = inputs_of(life_until(60, 85, 100.0));
  const auto all = advisories(joined(before, {replacement(10.5)}));
  EXPECT_EQ(all.back().action, AdvisoryAction::book_vessel);
  EXPECT_FALSE(all.back().request_for_work.empty());
  EXPECT_THAT(all.back().reasons.front(), HasSubstr("after later tests: this advice stands until the next test"));
}

TEST_F(AdvisoryGenerationTest, TestsFromBeforeTheLastOneOrTheReplacementChangeNothing) {
  const auto before = joined(inputs_of(life_until(60, 90, 100.0)), {replacement(90.5)});
  EXPECT_EQ(run(joined(before, inputs_of({{.month = 89.5, .rul_months = 0.5}}))), run(before));
}

TEST_F(AdvisoryGenerationTest, ATestOfUnknownTimeChangesNothingUnlessItFailed) {
  const auto before = inputs_of(life_until(60, 90, 100.0));
  TestCase undated{.month = 90.5, .forecast = ForecastState::insufficient_history, .used = false, .time_known = false};
  EXPECT_EQ(run(joined(before, inputs_of({undated}))), run(before));
  undated.verdict = PstVerdict::failed;
  EXPECT_GT(run(joined(before, inputs_of({undated}))).size(), run(before).size());
}

TEST_F(AdvisoryGenerationTest, OverdueTestIsAskedForAndGoesWithTheTest) {
  const auto before = inputs_of({{.month = 24}, {.month = 25}});
  const auto all = advisories(joined(joined(before, {overdue(26.4)}), inputs_of({{.month = 26.6}})));
  const auto called =
      std::find_if(all.begin(), all.end(), [](const auto& a) { return a.action == AdvisoryAction::repeat_test; });
  ASSERT_NE(called, all.end());
  EXPECT_EQ(called->priority, AdvisoryPriority::medium);
  EXPECT_THAT(called->recommendation, HasSubstr("overdue since " + ten_days_before(26.4)));
  EXPECT_EQ(all.back().action, AdvisoryAction::none);
}

TEST_F(AdvisoryGenerationTest, OverdueTestDoesNotHideTheBooking) {
  const auto all = advisories(joined(inputs_of(life_until(60, 85, 100.0)), {overdue(86.4)}));
  EXPECT_EQ(all.back().action, AdvisoryAction::book_vessel);
  EXPECT_FALSE(all.back().request_for_work.empty());
  EXPECT_THAT(all.back().reasons.front(), HasSubstr("overdue since " + ten_days_before(86.4)));
}

TEST_F(AdvisoryGenerationTest, TestWithoutTimeOrAssetStillGetsAnAnswer) {
  const auto no_time =
      advisories(inputs_of({{.forecast = ForecastState::insufficient_history, .used = false, .time_known = false}}));
  ASSERT_EQ(no_time.size(), 1u);
  EXPECT_EQ(no_time[0].action, AdvisoryAction::none);
  configuration_.assets.clear();
  EXPECT_EQ(advisories(inputs_of({{.month = 24}})).size(), 1u);
}

TEST_F(AdvisoryGenerationTest, OptionsAreChecked) {
  EXPECT_FALSE(AdvisoryGeneration::make(configuration_, {.largest_failure_probability = 0.9}));
}

}  // namespace
}  // namespace sealwatch::advisory_generation
