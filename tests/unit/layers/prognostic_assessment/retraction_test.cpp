// Tests that an operator retracts do not count, as if they had never been; what is withdrawn counts again.
#include "sealwatch/message/retraction.hpp"

#include <gmock/gmock.h>

#include "sealwatch/message/replacement_id.hpp"
#include "services/prognostic_assessment/prognostic_assessment.hpp"
#include "tests/unit/layers/prognostic_assessment/fixtures.hpp"
#include "tests/unit/layers/prognostic_assessment/layer_contract.hpp"

namespace sealwatch::prognostic_assessment {
namespace {

using namespace sealwatch::test;
using testing::Contains;
using testing::HasSubstr;

MaintenanceEvent event(std::string_view kind, const std::string& what, double month) {
  MaintenanceEvent said;
  said.asset_id = kAsset;
  said.kind = kind;
  said.reported_by = "J. Silva";
  said.remark = "wrong clock";
  said.header.event_time_known = true;
  said.header.event_time_ns = add_months(kInstalled, month).nanoseconds;
  said.header.message_id = retraction_id(kAsset, kind, what, {said.header.event_time_ns});
  return said;
}

class RetractionTest : public testing::Test {
 protected:
  std::vector<Message> run(const std::vector<Message>& inputs, std::optional<std::size_t> death_after = {}) const {
    return run_layer([this] { return PrognosticAssessment::make(configuration_, estimator_).value(); }, inputs,
                     death_after);
  }
  RemainingLife last_of(const std::vector<Message>& inputs) const { return of_kind<RemainingLife>(run(inputs)).back(); }
  /// What is forecast, without the words and ids that say how it came about.
  static void expect_same_forecast(RemainingLife a, RemainingLife b) {
    ASSERT_EQ(a.forecasts.size(), b.forecasts.size());
    for (std::size_t k = 0; k < a.forecasts.size(); ++k) a.forecasts[k].explanation = b.forecasts[k].explanation = "";
    EXPECT_EQ(a.forecasts, b.forecasts);
    EXPECT_EQ(a.condition, b.condition);
    EXPECT_EQ(a.tests_since_replacement, b.tests_since_replacement);
    EXPECT_EQ(a.header.event_time_ns, b.header.event_time_ns);
  }

  Configuration configuration_ = configuration();
  ScriptedEstimator estimator_;
};

TEST_F(RetractionTest, IdsSayWhatTheyMean) {
  const UtcTime when = add_months(kInstalled, 7.0);
  const auto test = retraction_of(kAsset, retraction_id(kAsset, kTestRetracted, "A-2010-x", when));
  ASSERT_TRUE(test);
  EXPECT_EQ(test->pst_id, "A-2010-x");
  const auto since = retraction_of(kAsset, retraction_id(kAsset, kTestsRetracted, format_utc(kInstalled), when));
  ASSERT_TRUE(since && since->since);
  EXPECT_EQ(*since->since, kInstalled);
  const auto back = retraction_of(kAsset, retraction_id(kAsset, kRetractionWithdrawn, since->id, when));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->withdrawn_id, since->id);
  for (const char* other : {"", "maintenance_event/XT03-MV2/2010-01-01T00:00:00Z", "retraction/XT03-MV2/test/x",
                            "retraction/XT03-MV2/since/never/x", "retraction/XT04/test/x/y"})
    EXPECT_FALSE(retraction_of(kAsset, other)) << other;
}

TEST_F(RetractionTest, OneTestIsForgottenAndComesBack) {
  auto wrong = straight_life(1, 40);
  for (std::size_t k = 35; k < 40; ++k) wrong[k].condition -= 0.03;  // five tests of a broken sensor
  auto inputs = inputs_of(wrong);
  const RemainingLife deceived = last_of(inputs);
  std::vector<std::string> ids;
  for (std::size_t k = 35; k < 40; ++k) {
    inputs.emplace_back(event(kTestRetracted, wrong[k].pst_id(), 40.1 + 0.01 * static_cast<double>(k)));
    ids.push_back(header_of(inputs.back()).message_id);
  }
  const RemainingLife without = last_of(inputs);
  expect_same_forecast(without, last_of(inputs_of(straight_life(1, 35))));
  EXPECT_NE(without.forecasts, deceived.forecasts);
  EXPECT_THAT(without.forecasts[0].explanation, HasSubstr("retracted by J. Silva (wrong clock)"));
  EXPECT_EQ(without.header.source_ids.front(), ids.back());
  for (const std::string& id : ids) inputs.emplace_back(event(kRetractionWithdrawn, id, 41.0));
  expect_same_forecast(last_of(inputs), deceived);
}

/// A clock that was years ahead: what comes after it with the right date is judged as the latest again.
TEST_F(RetractionTest, AllSinceADateAreForgottenAndLaterOnesCount) {
  auto inputs = inputs_of(straight_life(1, 30));
  for (const Message& message : inputs_of(straight_life(200, 203))) inputs.push_back(message);
  inputs.emplace_back(event(kTestsRetracted, format_utc(add_months(kInstalled, 100.0)), 30.5));
  expect_same_forecast(last_of(inputs), last_of(inputs_of(straight_life(1, 30))));
  for (const Message& message : inputs_of(straight_life(31, 33))) inputs.push_back(message);
  expect_same_forecast(last_of(inputs), last_of(inputs_of(straight_life(1, 33))));
  EXPECT_EQ(of_kind<PstRequest>(run(inputs)).back().header.pst_id, (TestCase{.month = 33}.pst_id()));
}

TEST_F(RetractionTest, AReplacementThatWasNoneIsUndone) {
  const auto life = inputs_of(straight_life(1, 40));
  MaintenanceEvent wrong = event("seal_replaced", "", 30.5);
  wrong.header.message_id = "maintenance_event/" + kAsset + "/" + format_utc({wrong.header.event_time_ns});
  auto inputs = life;
  inputs.emplace_back(wrong);
  EXPECT_EQ(last_of(inputs).tests_since_replacement, 10);
  inputs.emplace_back(event(kRetractionWithdrawn, wrong.header.message_id, 40.5));
  const RemainingLife undone = last_of(inputs);
  EXPECT_FALSE(undone.replacement_known);
  EXPECT_THAT(undone.forecasts[0].explanation, HasSubstr("replacement 'maintenance_event/"));
  expect_same_forecast(undone, last_of(life));
  inputs.emplace_back(wrong);  // of a service that had not received it before
  const auto next = inputs_of(straight_life(41, 42));
  inputs.insert(inputs.end(), next.begin(), next.end());
  expect_same_forecast(last_of(inputs), last_of(inputs_of(straight_life(1, 42))));
  const auto undisturbed = run(inputs);
  for (std::size_t death = inputs.size() - 8; death < inputs.size(); ++death)
    ASSERT_EQ(run(inputs, death), undisturbed) << death;
}

/// What was taken back is a report, not a moment: another report of the same moment counts, also after a restart.
TEST_F(RetractionTest, AReplacementThatWasTakenBackCanBeReportedAgain) {
  auto inputs = inputs_of(straight_life(1, 40));
  const auto report = [](double reported_month) {
    MaintenanceEvent said = event("seal_replaced", "", 30.5);
    said.header.message_id =
        replacement_id(kAsset, said.kind, add_months(kInstalled, reported_month), {said.header.event_time_ns});
    return said;
  };
  const MaintenanceEvent first = report(40.1), second = report(40.3);
  inputs.emplace_back(first);
  EXPECT_THAT(last_of(inputs).header.source_ids, Contains(first.header.message_id));
  inputs.emplace_back(event(kRetractionWithdrawn, first.header.message_id, 40.2));
  EXPECT_FALSE(last_of(inputs).replacement_known);
  inputs.emplace_back(second);
  EXPECT_THAT(last_of(inputs).header.source_ids, Contains(second.header.message_id));
  EXPECT_EQ(last_of(inputs).tests_since_replacement, 10);
  const auto next = inputs_of(straight_life(41, 42));
  inputs.insert(inputs.end(), next.begin(), next.end());
  EXPECT_EQ(last_of(inputs).tests_since_replacement, 12);
  EXPECT_THAT(last_of(inputs).header.source_ids, Contains(second.header.message_id));
  const auto undisturbed = run(inputs);
  for (std::size_t death = inputs.size() - 8; death < inputs.size(); ++death)
    ASSERT_EQ(run(inputs, death), undisturbed) << death;
}

TEST_F(RetractionTest, OfAllTestsLeavesNone) {
  auto inputs = inputs_of(straight_life(1, 10));
  inputs.emplace_back(event(kTestsRetracted, format_utc(kInstalled), 10.5));
  const RemainingLife life = last_of(inputs);
  EXPECT_FALSE(life.condition_known);
  EXPECT_THAT(life.forecasts.front().explanation, HasSubstr("no test counts"));
}

TEST_F(RetractionTest, DeathAnywhereChangesNothing) {
  auto life = straight_life(1, 24);
  auto inputs = inputs_of(life);
  const MaintenanceEvent early = event(kTestRetracted, life[20].pst_id(), 10.1);  // before its test is concluded
  const MaintenanceEvent since = event(kTestsRetracted, format_utc(add_months(kInstalled, 8.5)), 12.1);
  inputs.insert(inputs.begin() + 20, early);
  inputs.insert(inputs.begin() + 26, since);
  inputs.insert(inputs.begin() + 34, event(kRetractionWithdrawn, since.header.message_id, 15.0));
  const auto undisturbed = run(inputs);
  for (std::size_t death = 0; death < inputs.size(); ++death) ASSERT_EQ(run(inputs, death), undisturbed) << death;
}

/// Somebody tried the chain with the virtual bench before the actuator was recorded, with a clock of its own.
TEST_F(RetractionTest, MadeUpTestsAreForgottenOnceOneIsRecorded) {
  auto tried = straight_life(1, 40);
  for (TestCase& one : tried) one.month += 30.0, one.condition -= 0.1;
  std::vector<Message> inputs = inputs_of(tried);
  for (Message& message : inputs) {
    header_of(message).pst_id += kEndOfMadeUpId;
    header_of(message).message_id += kEndOfMadeUpId;
  }
  const auto recorded = inputs_of(straight_life(1, 40));
  inputs.insert(inputs.end(), recorded.begin(), recorded.end());
  expect_same_forecast(last_of(inputs), last_of(recorded));
  EXPECT_EQ(of_kind<PstRequest>(run(inputs)).back().header.pst_id, (TestCase{.month = 40}.pst_id()));
  for (const std::size_t death : {std::size_t{60}, std::size_t{85}, std::size_t{100}})
    EXPECT_EQ(of_kind<RemainingLife>(run(inputs, death)).back(), last_of(inputs)) << death;
}

}  // namespace
}  // namespace sealwatch::prognostic_assessment
