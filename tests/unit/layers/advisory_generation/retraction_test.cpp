// Advice after a retraction: it says who and why, is renewed once the layers below have answered, and the next test is
// judged with those that count.
#include "sealwatch/message/retraction.hpp"

#include <gmock/gmock.h>

#include "services/advisory_generation/advisory_generation.hpp"
#include "tests/unit/layers/advisory_generation/fixtures.hpp"
#include "tests/unit/layers/prognostic_assessment/layer_contract.hpp"

namespace sealwatch::advisory_generation {
namespace {

using namespace sealwatch::test;
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

class AdviceAfterRetraction : public testing::Test {
 protected:
  std::vector<Message> run(const std::vector<Message>& inputs, std::optional<std::size_t> death_after = {}) const {
    return run_layer([this] { return AdvisoryGeneration::make(configuration_).value(); }, inputs, death_after);
  }
  Advisory last_of(const std::vector<Message>& inputs) const { return of_kind<Advisory>(run(inputs)).back(); }

  Configuration configuration_ = configuration();
};

std::vector<Message> joined(std::vector<Message> inputs, const std::vector<Message>& more) {
  inputs.insert(inputs.end(), more.begin(), more.end());
  return inputs;
}

/// What the layers below say of `last`, the last test that counts, after a retraction.
std::vector<Message> answers(const Message& retraction, const TestCase& last) {
  RemainingLife life = last.life();
  HealthReport health = last.health();
  StateReport state = last.state();
  for (Header* header : {&life.header, &health.header, &state.header}) {
    header->message_id += "/after/" + header_of(retraction).message_id;
    header->pst_id.clear();
    header->source_ids = {header_of(retraction).message_id};
  }
  return {state, life, health};
}

/// Steep, then flat: what five tests of a broken sensor asked for.
std::vector<Message> deceived_life() {
  auto tests = life_until(60, 70, 200.0);
  for (const TestCase& wrong : life_until(71, 75, 84.0)) tests.push_back(wrong);
  return inputs_of(tests);
}

TEST_F(AdviceAfterRetraction, IsRenewedAtOnce) {
  const auto deceived = deceived_life();
  ASSERT_NE(last_of(deceived).action, AdvisoryAction::none);
  const MaintenanceEvent since = event(kTestsRetracted, format_utc(add_months(kInstalled, 70.5)), 75.5);
  auto inputs = joined(deceived, {since});
  const Advisory before = last_of(deceived);
  EXPECT_EQ(last_of(inputs).action, before.action) << "until the others have answered";
  inputs = joined(inputs, answers(since, life_until(70, 70, 200.0).front()));
  const Advisory renewed = last_of(inputs);
  EXPECT_EQ(renewed.action, AdvisoryAction::none);
  EXPECT_EQ(renewed.supersedes_id, before.advisory_id);
  EXPECT_EQ(renewed.recommendation, last_of(inputs_of(life_until(60, 70, 200.0))).recommendation);
  const auto next = inputs_of(life_until(76, 76, 200.0));
  EXPECT_EQ(last_of(joined(inputs, next)).reasons, last_of(joined(inputs_of(life_until(60, 70, 200.0)), next)).reasons);
}

TEST_F(AdviceAfterRetraction, OfAllTestsAsksForNothing) {
  const MaintenanceEvent since = event(kTestsRetracted, format_utc(kInstalled), 75.5);
  TestCase none{.month = 75.5, .forecast = ForecastState::insufficient_history, .verdict = PstVerdict::not_judged};
  auto replies = answers(since, none);
  std::get<RemainingLife>(replies[1]).condition_known = false;
  std::get<StateReport>(replies[0]).verdict_reasons.clear();
  const Advisory renewed = last_of(joined(joined(deceived_life(), {since}), replies));
  EXPECT_EQ(renewed.action, AdvisoryAction::none) << renewed.recommendation;
}

/// The answers may come first, and alone where this service was dead when the retraction was said.
TEST_F(AdviceAfterRetraction, IsRenewedByTheAnswersAlone) {
  const MaintenanceEvent since = event(kTestsRetracted, format_utc(add_months(kInstalled, 70.5)), 75.5);
  const auto replies = answers(since, life_until(70, 70, 200.0).front());
  const Advisory alone = last_of(joined(deceived_life(), replies));
  EXPECT_EQ(alone.action, AdvisoryAction::none);
  EXPECT_EQ(last_of(joined(joined(deceived_life(), replies), {since})).header.message_id, alone.header.message_id);
}

TEST_F(AdviceAfterRetraction, LateAnswersDoNotTakeThePlaceOfALaterTest) {
  const MaintenanceEvent since = event(kTestsRetracted, format_utc(add_months(kInstalled, 70.5)), 75.5);
  const auto next = joined(joined(deceived_life(), {since}), inputs_of(life_until(76, 76, 200.0)));
  const auto replies = answers(since, life_until(70, 70, 200.0).front());
  EXPECT_EQ(last_of(joined(next, replies)).header.message_id, last_of(next).header.message_id);
  EXPECT_EQ(last_of(next).header.pst_id, TestCase{.month = 76}.pst_id());
}

MaintenanceEvent replaced(double month) {
  MaintenanceEvent said;
  said.asset_id = kAsset;
  said.kind = "seal_replaced";
  said.reported_by = "M. Okoye";
  said.header.event_time_known = true;
  said.header.event_time_ns = add_months(kInstalled, month).nanoseconds;
  said.header.message_id = "maintenance_event/" + kAsset + "/" + format_utc({said.header.event_time_ns});
  return said;
}

TEST_F(AdviceAfterRetraction, AReplacementThatWasNoneIsUndone) {
  const auto worn = inputs_of(life_until(60, 75, 84.0));
  const MaintenanceEvent wrong = replaced(75.5);
  const MaintenanceEvent undone = event(kRetractionWithdrawn, wrong.header.message_id, 75.6);
  const Advisory before = last_of(worn);
  ASSERT_NE(before.action, AdvisoryAction::none);
  auto inputs = joined(worn, {wrong});
  ASSERT_EQ(last_of(inputs).action, AdvisoryAction::none);
  inputs = joined(joined(inputs, {undone}), answers(undone, life_until(75, 75, 84.0).front()));
  const Advisory renewed = last_of(inputs);
  EXPECT_EQ(renewed.action, before.action);
  EXPECT_EQ(renewed.priority, before.priority);
  EXPECT_EQ(renewed.recommendation, before.recommendation);
  EXPECT_EQ(renewed.request_for_work.front().work_id, before.request_for_work.front().work_id) << "of the same seal";
  const auto next = inputs_of(life_until(76, 76, 84.0));
  EXPECT_EQ(last_of(joined(inputs, next)).reasons, last_of(joined(worn, next)).reasons);
  EXPECT_EQ(run(joined(inputs, {wrong})).size(), run(inputs).size()) << "the same report again is none";
}

/// One test of a wrong year silences all that follow, until it is retracted.
TEST_F(AdviceAfterRetraction, ATestOfTheFutureNoLongerHidesTheOthers) {
  const auto before = inputs_of(life_until(24, 30, 120.0));
  const auto deceived = joined(before, inputs_of(life_until(118, 118, 120.0)));
  const auto after = inputs_of(life_until(31, 34, 120.0));
  EXPECT_NE(last_of(joined(deceived, after)).header.pst_id, TestCase{.month = 34}.pst_id());
  const auto mended = joined(deceived, {event(kTestRetracted, TestCase{.month = 118}.pst_id(), 30.5)});
  const Advisory answer = last_of(mended);
  EXPECT_THAT(answer.reasons.front(), HasSubstr("retracted by J. Silva (wrong clock): this advice is about to be"));
  EXPECT_EQ(answer.header.message_id, "advisory/" + header_of(mended.back()).message_id);
  const Advisory now = last_of(joined(mended, after));
  const Advisory undisturbed = last_of(joined(before, after));
  EXPECT_EQ(now.header.pst_id, undisturbed.header.pst_id);
  EXPECT_EQ(now.action, undisturbed.action);
  EXPECT_EQ(now.priority, undisturbed.priority);
  EXPECT_EQ(now.reasons, undisturbed.reasons);
}

TEST_F(AdviceAfterRetraction, WithdrawnItIsAsItWas) {
  const auto before = inputs_of(life_until(24, 40, 60.0));
  const MaintenanceEvent since = event(kTestsRetracted, format_utc(add_months(kInstalled, 29.5)), 40.1);
  const auto both = joined(before, {since, event(kRetractionWithdrawn, since.header.message_id, 40.2)});
  const auto next = inputs_of(life_until(41, 41, 60.0));
  EXPECT_EQ(last_of(joined(both, next)).reasons, last_of(joined(before, next)).reasons);
}

/// The estimate of the test that is the last again is sent by nobody: its advice lost condition and margins.
TEST_F(AdviceAfterRetraction, KeepsWhatTheLastTestThatCountsSaidOfItself) {
  configuration_.assets.front().parameters = {
      {"A_C", {5.89e-3, 0, 1, false}}, {"x_C", {0.08, 0, 1, false}}, {"phi", {6e4, 0, 1e6, false}}};
  const auto tests = [](int first, int last) {
    std::vector<Message> inputs = inputs_of(life_until(first, last, 200.0));
    for (Message& input : inputs)
      if (auto* leakage = std::get_if<LeakageEstimate>(&input)) leakage->resistance_Pa_s_m3 = 2.6e13;
    return inputs;
  };
  const auto before = tests(60, 70);
  const auto all = joined(before, tests(71, 71));
  const MaintenanceEvent one = event(kTestRetracted, TestCase{.month = 71}.pst_id(), 71.5);
  const auto replies = answers(one, life_until(70, 70, 200.0).front());
  const auto inputs = joined(joined(all, {one}), replies);
  const Advisory expected = last_of(before);
  ASSERT_TRUE(expected.safety.front().margin_known);
  ASSERT_THAT(expected.reasons, testing::Contains(HasSubstr("leakage resistance R_CL =")));
  for (std::size_t death = all.size(); death <= inputs.size(); ++death) {
    const Advisory renewed = of_kind<Advisory>(run(inputs, death)).back();
    EXPECT_EQ(renewed.reasons, expected.reasons);
    EXPECT_EQ(renewed.safety, expected.safety);
  }
}

TEST_F(AdviceAfterRetraction, DeathAnywhereChangesNothing) {
  auto inputs = inputs_of(life_until(60, 80, 100.0));
  const MaintenanceEvent since = event(kTestsRetracted, format_utc(add_months(kInstalled, 66.5)), 70.1);
  inputs.insert(inputs.begin() + 20, event(kTestRetracted, TestCase{.month = 75}.pst_id(), 65.1));
  inputs.insert(inputs.begin() + 45, since);
  const MaintenanceEvent back = event(kRetractionWithdrawn, since.header.message_id, 75.0);
  inputs.insert(inputs.begin() + 60, back);
  for (const Message& answer : answers(since, life_until(66, 66, 100.0).front()))
    inputs.insert(inputs.begin() + 47, answer);
  const MaintenanceEvent wrong = replaced(77.5);
  inputs.insert(inputs.end() - 8, wrong);
  const MaintenanceEvent undone = event(kRetractionWithdrawn, wrong.header.message_id, 78.5);
  inputs.insert(inputs.end() - 4, undone);
  for (const Message& answer : answers(undone, life_until(79, 79, 100.0).front())) inputs.push_back(answer);
  for (const TestCase& urgent : life_until(84, 88, 90.0))  // what takes force at once does so after a restart as well
    for (const Message& message : urgent.messages()) inputs.push_back(message);
  inputs.push_back(event(kTestRetracted, TestCase{.month = 88}.pst_id(), 88.5));
  const auto undisturbed = run(inputs);
  for (std::size_t death = 0; death < inputs.size(); ++death) ASSERT_EQ(run(inputs, death), undisturbed) << death;
}

/// Somebody tried the chain with the virtual bench before the actuator was recorded, with a clock of its own.
TEST_F(AdviceAfterRetraction, MadeUpTestsAreForgottenOnceOneIsRecorded) {
  auto made_up = inputs_of(life_until(100, 110, 115.0));
  for (Message& message : made_up) {
    header_of(message).pst_id += kEndOfMadeUpId;
    header_of(message).message_id += kEndOfMadeUpId;
  }
  ASSERT_NE(last_of(made_up).action, AdvisoryAction::none);
  const auto recorded = inputs_of(life_until(60, 66, 200.0));
  const auto inputs = joined(made_up, recorded);
  const Advisory advice = last_of(inputs);
  EXPECT_EQ(advice.action, AdvisoryAction::none) << advice.recommendation;
  EXPECT_EQ(advice.reasons, last_of(recorded).reasons);
  EXPECT_EQ(advice.header.pst_id, (TestCase{.month = 66}.pst_id()));
  for (std::size_t death = made_up.size(); death < inputs.size(); death += 5)
    EXPECT_EQ(of_kind<Advisory>(run(inputs, death)).back(), advice) << death;
}

}  // namespace
}  // namespace sealwatch::advisory_generation
