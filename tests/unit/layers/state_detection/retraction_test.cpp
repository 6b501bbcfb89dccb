// What a retracted test taught is forgotten: all that is said afterwards is what would be said had it never been.
#include "sealwatch/message/retraction.hpp"

#include <gmock/gmock.h>

#include "services/common/message/json.hpp"
#include "services/state_detection/sensor_alarms.hpp"
#include "services/state_detection/state_detection.hpp"
#include "tests/unit/layers/state_detection/fake_simulator.hpp"
#include "tests/unit/layers/state_detection/synthetic_test.hpp"

namespace sealwatch {
namespace {

using synthetic::Circumstances;
using synthetic::Condition;
using testing::HasSubstr;

constexpr const char* kAsset = "A1";

/// A layer with its journal.
class Detection {
 public:
  StateReport take(const Message& input) {
    received_.push_back(input);
    return add(layer_->receive(input));
  }
  /// As after a crash, with what was not consumed given again.
  void restart() {
    layer_ = make();
    for (const Message& output : concluded_) layer_->restore(output);
    for (const Message& input : std::vector(received_))
      if (!std::ranges::count(consumed_, header_of(input).message_id)) add(layer_->receive(input));
  }
  StateReport test(int number, const Condition& condition = {}, const Circumstances& about = {}) {
    Circumstances circumstances = about;
    circumstances.number = number;
    circumstances.asset_id = kAsset;
    const synthetic::Test made = synthetic::make(condition, circumstances);
    take(made.window);
    return take(made.features);
  }
  /// By the virtual bench.
  StateReport made_up_test(int number, const Condition& condition = {}) {
    Circumstances circumstances;
    circumstances.number = number;
    circumstances.asset_id = kAsset;
    const synthetic::Test made = synthetic::make_up(condition, circumstances);
    take(made.window);
    return take(made.features);
  }
  StateReport say(std::string_view kind, const std::string& what, int month,
                  const std::optional<std::vector<std::string>>& tests = {}) {
    MaintenanceEvent event;
    event.asset_id = kAsset;
    event.kind = kind;
    event.reported_by = "J. Silva";
    event.remark = "wrong valve";
    event.header.event_time_known = true;
    event.header.event_time_ns = synthetic::month(month, 20).nanoseconds;
    event.header.message_id = retraction_id(kAsset, kind, what, {event.header.event_time_ns});
    event.tests_known = tests.has_value();
    event.test_ids = tests.value_or(std::vector<std::string>());
    return take(event);
  }
  std::string replaced(int month) {
    MaintenanceEvent event;
    event.asset_id = kAsset;
    event.kind = "seal_replaced";
    event.header.event_time_known = true;
    event.header.event_time_ns = synthetic::month(month, 20).nanoseconds;
    event.header.message_id = "maintenance_event/" + event.asset_id + "/" + format_utc(synthetic::month(month, 20));
    take(event);
    return event.header.message_id;
  }
  std::optional<StateReport> tick(UtcTime now) {
    Conclusion conclusion = layer_->tick(now);
    if (conclusion.outputs.empty()) return std::nullopt;
    return add(std::move(conclusion));
  }

 private:
  static std::unique_ptr<StateDetection> make() {
    const std::vector<AssetConfig> assets = {synthetic::asset(kAsset)};
    return std::make_unique<StateDetection>(assets, std::make_shared<synthetic::FakeSimulator>(1.5, 0.0, 1e13));
  }
  StateReport add(Conclusion conclusion) {
    StateReport last;
    for (const Message& output : conclusion.outputs) {
      concluded_.push_back(output);
      last = std::get<StateReport>(output);
    }
    for (const std::string& id : conclusion.consumed) consumed_.push_back(id);
    return last;
  }
  std::unique_ptr<StateDetection> layer_ = make();
  std::vector<Message> received_, concluded_;
  std::vector<std::string> consumed_;
};

Condition stiff() {
  Condition condition;
  condition.friction_N = 3600;  // of another actuator: its baseline would be far off
  return condition;
}

std::string text(const StateReport& report) { return to_json(Message(report), JsonForm::exact); }

/// The judgements alone, in readable form.
std::string judgements_of(const StateReport& report) {
  StateReport alone;
  alone.judgements = report.judgements;
  alone.region = report.region;
  return text(alone);
}

TEST(Retraction, ATestOfTheBaselineTeachesNothingMore) {
  for (const bool restarted : {false, true}) {
    Detection deceived, undisturbed;
    std::string wrong;
    for (int number = 0; number < 5; ++number) {
      undisturbed.test(number);
      deceived.test(number);
      if (number == 2) wrong = deceived.test(50 + number, stiff()).header.pst_id;
    }
    const StateReport before = deceived.test(5);
    const StateReport never = undisturbed.test(5);
    ASSERT_NE(text(before), text(never)) << "it would not show";
    const StateReport answer = deceived.say(kTestRetracted, wrong, 5);
    EXPECT_EQ(judgements_of(answer), judgements_of(never)) << "said of the last test at once";
    EXPECT_THAT(answer.verdict_reasons.front(), HasSubstr("retracted by J. Silva (wrong valve)"));
    if (restarted) deceived.restart();
    for (int number = 6; number < 16; ++number)
      ASSERT_EQ(text(deceived.test(number, {}, {})), text(undisturbed.test(number))) << number;
  }
}

TEST(Retraction, RegionsAndDueDatesAreThoseWithoutTheTests) {
  Detection deceived, undisturbed;
  for (int number = 0; number < 14; ++number) {
    undisturbed.test(number);
    deceived.test(number);
  }
  for (int number = 14; number < 17; ++number) deceived.test(number, stiff());
  ASSERT_EQ(deceived.test(17, stiff()).region, AlertRegion::alarm) << "it would not show";
  const StateReport answer = deceived.say(kTestsRetracted, format_utc(synthetic::month(13, 25)), 18);
  EXPECT_EQ(answer.region, AlertRegion::normal);
  const auto overdue = deceived.tick(synthetic::month(15, 20));
  const auto never = undisturbed.tick(synthetic::month(15, 20));
  ASSERT_TRUE(overdue && never);
  EXPECT_EQ(text(*overdue), text(*never)) << "the last test that counts is that of month 13";
  EXPECT_EQ(text(deceived.test(18)), text(undisturbed.test(18)));
}

TEST(Retraction, AChannelThatOnlyRetractedTestsHadIsNotMissed) {
  Detection deceived, undisturbed;
  Circumstances without_flow;
  without_flow.absent_channel = "flow";
  std::vector<std::string> wrong;
  for (int number = 0; number < 3; ++number) wrong.push_back(deceived.test(number).header.pst_id);
  for (int number = 3; number < 5; ++number) {
    deceived.test(number, {}, without_flow);
    undisturbed.test(number, {}, without_flow);
  }
  LostSensors lost;
  ASSERT_EQ(lost.look(deceived.test(5, {}, without_flow))->standing.size(), 1U) << "it would not show";
  undisturbed.test(5, {}, without_flow);
  StateReport answer;
  for (const std::string& pst_id : wrong)
    answer = deceived.say(kTestRetracted, pst_id, 6 + static_cast<int>(answer.asset_id.size()));
  EXPECT_TRUE(answer.stale_channels.empty());
  const auto said = lost.look(answer);
  ASSERT_TRUE(said);
  EXPECT_TRUE(said->standing.empty()) << "the alarm is over";
  EXPECT_EQ(text(deceived.test(9, {}, without_flow)), text(undisturbed.test(9, {}, without_flow)));
}

TEST(Retraction, WithdrawnItIsAsItWas) {
  Detection changed, undisturbed;
  std::string wrong;
  for (int number = 0; number < 6; ++number) {
    const StateReport report = changed.test(number, number == 2 ? stiff() : Condition{});
    if (number == 2) wrong = report.header.pst_id;
    undisturbed.test(number, number == 2 ? stiff() : Condition{});
  }
  const StateReport answer = changed.say(kTestRetracted, wrong, 6);
  changed.say(kRetractionWithdrawn, answer.header.source_ids.front(), 7);
  for (int number = 8; number < 12; ++number)
    ASSERT_EQ(text(changed.test(number)), text(undisturbed.test(number))) << number;
}

TEST(Retraction, OfATestThatIsStillToComeHoldsWhenItComes) {
  for (const bool restarted : {false, true}) {
    Detection warned, undisturbed;
    Circumstances fourth;
    fourth.number = 3;
    fourth.asset_id = kAsset;
    const std::string wrong = synthetic::make(stiff(), fourth).features.header.pst_id;
    for (int number = 0; number < 3; ++number) {
      warned.test(number);
      undisturbed.test(number);
    }
    warned.say(kTestRetracted, wrong, 3);
    warned.test(3, stiff());
    if (restarted) warned.restart();
    for (int number = 4; number < 10; ++number)
      ASSERT_EQ(judgements_of(warned.test(number)), judgements_of(undisturbed.test(number))) << number;
  }
}

/// Fetched back when later tests are known, it means those that it meant (message/act_record.hpp).
TEST(Retraction, OfAllSinceADateMeansTheTestsThatItNames) {
  for (const bool restarted : {false, true}) {
    Detection deceived, undisturbed;
    for (int number = 0; number < 5; ++number) {
      deceived.test(number);
      undisturbed.test(number);
    }
    const std::string wrong = deceived.test(40, stiff()).header.pst_id;
    deceived.test(50);
    undisturbed.test(50);
    const StateReport answer = deceived.say(kTestsRetracted, format_utc(synthetic::month(30, 1)), 51, {{wrong}});
    EXPECT_TRUE(answer.retracted_tests_known);
    EXPECT_EQ(answer.retracted_test_ids, std::vector<std::string>{wrong});
    if (restarted) deceived.restart();
    for (int number = 51; number < 58; ++number)
      ASSERT_EQ(judgements_of(deceived.test(number)), judgements_of(undisturbed.test(number))) << number;
  }
}

TEST(Retraction, AReplacementThatWasNoneIsUndone) {
  for (const int tests_since : {0, 3}) {
    for (const bool restarted : {false, true}) {
      Detection changed, undisturbed;
      int number = 0;
      for (; number < 6; ++number) {
        changed.test(number);
        undisturbed.test(number);
      }
      const std::string wrong = changed.replaced(5);
      for (const int end = number + tests_since; number < end; ++number)
        EXPECT_NE(text(changed.test(number, stiff())), text(undisturbed.test(number, stiff()))) << "it would not show";
      const StateReport answer = changed.say(kRetractionWithdrawn, wrong, number);
      EXPECT_THAT(answer.verdict_reasons.front(), HasSubstr("replacement '" + wrong + "' withdrawn by J. Silva"));
      if (restarted) changed.restart();
      for (const int end = number + 8; number < end; ++number)
        ASSERT_EQ(text(changed.test(number)), text(undisturbed.test(number))) << number;
    }
  }
}

/// Somebody tried the chain with the virtual bench before the actuator was recorded.
TEST(Retraction, MadeUpTestsTeachNothingOnceOneIsRecorded) {
  for (const bool restarted : {false, true}) {
    Detection tried, undisturbed;
    for (int number = 0; number < 12; ++number) tried.made_up_test(number + 30, stiff());
    for (int number = 0; number < 16; ++number) {
      ASSERT_EQ(text(tried.test(number)), text(undisturbed.test(number))) << number;
      if (number == 8) tried.made_up_test(50, stiff());
      if (restarted) tried.restart();
    }
    const auto overdue = tried.tick(synthetic::month(17, 20));
    const auto never = undisturbed.tick(synthetic::month(17, 20));
    ASSERT_TRUE(overdue && never);
    EXPECT_EQ(text(*overdue), text(*never)) << "the last test is a recorded one";
  }
}

}  // namespace
}  // namespace sealwatch
