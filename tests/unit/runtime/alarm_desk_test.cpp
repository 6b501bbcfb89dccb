// The states of alarms after ISA-18.2: what each act and each moment makes of them, across restarts.
#include "services/common/runtime/alarm_desk.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/common/runtime/operator_acts.hpp"
#include "services/common/runtime/recalled_alarm_acts.hpp"
#include "tests/unit/runtime/harness.hpp"

namespace sealwatch::testing {
namespace {

using std::chrono::hours;
using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const UtcTime kNoon = parse_utc("2031-04-12T12:00:00Z").value();
constexpr std::int64_t kDay_ns = 86'400'000'000'000;

ServiceAlarm lost(const std::string& channel, const std::string& asset_id = "A") {
  return {.kind = "sensor_lost", .asset_id = asset_id, .subject = channel, .pst_id = {}, .text = "flat", .since_ns = 1};
}

StandingAdvice advice(const std::string& id, std::int64_t due_ns = 0, std::string_view kind = kAdviceAlarm) {
  StandingAdvice said{.asset_id = "A", .advice = AlarmEntry{}, .is_answered = false};
  said.advice->alarm = {
      .kind = std::string(kind), .asset_id = "A", .subject = id, .pst_id = {}, .text = id, .since_ns = 1};
  said.advice->due_ns = due_ns;
  return said;
}

MaintenanceEvent event(std::string_view kind, const std::string& asset_id, const AlarmAct& act, UtcTime when = kNoon) {
  MaintenanceEvent said;
  said.asset_id = asset_id;
  said.kind = kind;
  said.reported_by = "J. Silva";
  said.remark = "ordered";
  said.header.event_time_known = true;
  said.header.event_time_ns = when.nanoseconds;
  said.header.message_id = alarm_act_id(asset_id, when, act);
  return said;
}

/// A desk with a journal of its own, which may be left and taken up again.
class Desk : public ::testing::Test {
 protected:
  Desk() { restart(); }
  void restart() {
    std::vector<AlarmEntry> kept;
    for (const auto& [key, entry] : journal_) kept.push_back(entry);
    desk_ = std::make_unique<AlarmDesk>(
        AlarmDesk::Options{.service = "advisory_generation", .services = {"data_acquisition", "state_detection"}}, kept,
        steady_, time_);
  }
  void keep() {
    AlarmDesk::Changes changes = desk_->take_changes();
    for (const AlarmEntry& one : changes.kept) journal_[{one.alarm.kind, one.alarm.asset_id, one.alarm.subject}] = one;
    for (const ServiceAlarm& one : changes.forgotten) journal_.erase({one.kind, one.asset_id, one.subject});
  }
  /// Both services beat for so long, every second; state detection tells `alarms`.
  void pass(seconds time, const std::vector<ServiceAlarm>& alarms = {}, bool acquisition_beats = true) {
    for (seconds k{0}; k < time; ++k) {
      steady_ += seconds(1);
      time_ = add_seconds(time_, 1.0);
      ServiceStatus status;
      status.service = "state_detection";
      status.alarms = alarms;
      status.alarm_count = alarms.size();
      desk_->hear(status, steady_, time_);
      status = {};
      status.service = "data_acquisition";
      if (acquisition_beats) desk_->hear(status, steady_, time_);
      desk_->look(steady_, time_);
      keep();
    }
  }
  std::string apply(std::string_view kind, const std::string& alarm, std::optional<UtcTime> until = {}) {
    const auto refused = desk_->apply(event(kind, "A", {.alarm_id = alarm, .until = until}, time_), time_);
    keep();
    return refused.value_or("");
  }
  void acknowledge(const std::string& id) {
    Acknowledgement seen;
    seen.asset_id = "A";
    seen.advisory_id = id;
    seen.acknowledged_by = "M. Okoye";
    ASSERT_TRUE(desk_->takes(seen));
    desk_->acknowledge(seen, time_);
    keep();
  }
  std::vector<std::string> states() {
    ServiceStatus status;
    desk_->tell(status, time_);
    std::vector<std::string> said;
    for (const AlarmEntry& one : status.desk)
      said.push_back(alarm_id(one.alarm) + " " + std::string(name_of(state_of(one, time_))));
    return said;
  }

  std::map<std::tuple<std::string, std::string, std::string>, AlarmEntry> journal_;
  std::chrono::nanoseconds steady_ = hours(1);
  UtcTime time_ = kNoon;
  std::unique_ptr<AlarmDesk> desk_;
};

TEST_F(Desk, AnAlarmThatEndedUnseenStaysUntilSomebodySaysThatItWasSeen) {
  pass(seconds(2), {lost("flow")});
  EXPECT_THAT(states(), ElementsAre("sensor_lost/flow unacknowledged"));
  pass(seconds(9));
  EXPECT_THAT(states(), ElementsAre("sensor_lost/flow unacknowledged")) << "a moment's silence ends nothing";
  pass(seconds(5));
  EXPECT_THAT(states(), ElementsAre("sensor_lost/flow returned"));
  restart();
  EXPECT_THAT(states(), ElementsAre("sensor_lost/flow returned"));
  acknowledge("sensor_lost/flow");
  EXPECT_THAT(states(), IsEmpty());
  EXPECT_THAT(journal_, IsEmpty());
}

TEST_F(Desk, AnAcknowledgedAlarmEndsWithItsCauseAndANewOccurrenceIsUnseen) {
  pass(seconds(2), {lost("flow")});
  acknowledge("sensor_lost/flow");
  restart();
  pass(seconds(2), {lost("flow")});
  EXPECT_THAT(states(), ElementsAre("sensor_lost/flow acknowledged")) << "a restart of the desk forgets nothing";
  pass(seconds(15));
  EXPECT_THAT(states(), IsEmpty());
  pass(seconds(2), {lost("flow")});
  EXPECT_THAT(states(), ElementsAre("sensor_lost/flow unacknowledged"));
}

TEST_F(Desk, AShelfHidesOneAlarmAndEndsByItself) {
  pass(seconds(2), {lost("flow")});
  const UtcTime until = add_seconds(time_, 60.0);
  EXPECT_EQ(apply(kAlarmShelved, "sensor_lost/flow", until), "");
  pass(seconds(30), {lost("flow"), lost("position")});
  EXPECT_THAT(states(), ElementsAre("sensor_lost/position unacknowledged", "sensor_lost/flow shelved"))
      << "a new alarm is seen";
  pass(seconds(40), {lost("flow"), lost("position")});
  EXPECT_THAT(states(), ElementsAre("sensor_lost/flow unacknowledged", "sensor_lost/position unacknowledged"));
}

TEST_F(Desk, AShelfEndsAlsoWhileNothingRuns) {
  pass(seconds(2), {lost("flow")});
  EXPECT_EQ(apply(kAlarmShelved, "sensor_lost/flow", UtcTime{time_.nanoseconds + kDay_ns}), "");
  restart();
  EXPECT_THAT(states(), ElementsAre("sensor_lost/flow shelved"));
  time_ = UtcTime{time_.nanoseconds + 2 * kDay_ns};
  restart();
  EXPECT_THAT(states(), ElementsAre("sensor_lost/flow unacknowledged"));
}

TEST_F(Desk, AnAlarmThatEndsOnTheShelfIsToldWhenTheShelfEnds) {
  pass(seconds(2), {lost("flow"), lost("position")});
  for (const char* one : {"sensor_lost/flow", "sensor_lost/position"})
    EXPECT_EQ(apply(kAlarmShelved, one, add_seconds(time_, 60.0)), "");
  acknowledge("sensor_lost/position");
  pass(seconds(20));
  EXPECT_THAT(states(), ElementsAre("sensor_lost/flow shelved", "sensor_lost/position shelved"));
  pass(seconds(60));
  EXPECT_THAT(states(), ElementsAre("sensor_lost/flow returned")) << "the other one was seen";
}

TEST_F(Desk, WhatWasSeenAndComesAgainOnTheShelfIsANewOccurrence) {
  pass(seconds(2), {lost("flow")});
  EXPECT_EQ(apply(kAlarmShelved, "sensor_lost/flow", add_seconds(time_, 60.0)), "");
  acknowledge("sensor_lost/flow");
  pass(seconds(20));
  pass(seconds(5), {lost("flow")});
  EXPECT_THAT(states(), ElementsAre("sensor_lost/flow shelved"));
  pass(seconds(60), {lost("flow")});
  EXPECT_THAT(states(), ElementsAre("sensor_lost/flow unacknowledged"));
}

TEST_F(Desk, WhatCannotBeDoneIsRefusedWithItsReason) {
  pass(seconds(2), {lost("flow")});
  EXPECT_THAT(apply(kAlarmShelved, "sensor_lost/pressure_a", add_seconds(time_, 60.0)),
              HasSubstr("no alarm 'sensor_lost/pressure_a' of A"));
  EXPECT_THAT(apply(kAlarmShelved, "sensor_lost/flow", add_seconds(time_, -60.0)), HasSubstr("is past"));
  EXPECT_THAT(apply(kAlarmShelved, "sensor_lost/flow", add_months(time_, 13.0)), HasSubstr("more than a year ahead"));
  EXPECT_THAT(apply(kAlarmUnshelved, "sensor_lost/flow"), HasSubstr("is not shelved"));
  EXPECT_THAT(apply(kAssetInService, ""), HasSubstr("A is not out of service"));
  EXPECT_EQ(apply(kAlarmShelved, "sensor_lost/flow", add_seconds(time_, 60.0)), "");
  EXPECT_EQ(apply(kAlarmUnshelved, "sensor_lost/flow"), "");
  EXPECT_THAT(states(), ElementsAre("sensor_lost/flow unacknowledged"));
}

TEST_F(Desk, AllAlarmsOfAnAssetOnWhichSomebodyWorksAreOutOfServiceUntilItIsTakenBack) {
  EXPECT_EQ(apply(kAssetOutOfService, ""), "");
  EXPECT_THAT(apply(kAssetOutOfService, ""), HasSubstr("already, by J. Silva"));
  restart();
  pass(seconds(2), {lost("flow"), lost("flow", "B")});
  EXPECT_THAT(states(), ElementsAre("sensor_lost/flow unacknowledged", "out_of_service out_of_service",
                                    "sensor_lost/flow out_of_service"))
      << "that of B is seen";
  EXPECT_EQ(apply(kAssetInService, ""), "");
  EXPECT_THAT(states(), ElementsAre("sensor_lost/flow unacknowledged", "sensor_lost/flow unacknowledged"));
}

TEST_F(Desk, ASilentServiceIsAnAlarmThatSuppressesTheOverdueTestsItCauses) {
  desk_->stand(advice("overdue test", 0, kOverdueAlarm), time_);
  pass(seconds(5));
  EXPECT_THAT(states(), ElementsAre("overdue test unacknowledged"));
  pass(seconds(12), {}, false);
  EXPECT_THAT(states(), ElementsAre("no_heartbeat/data_acquisition unacknowledged", "overdue test suppressed"));
  EXPECT_EQ(apply(kAlarmShelved, "no_heartbeat/data_acquisition", {}),
            "its message_id, '" + alarm_act_id("A", time_, {.alarm_id = "no_heartbeat/data_acquisition", .until = {}}) +
                "', does not say which alarm is meant");
  const auto shelved =
      event(kAlarmShelved, "", {.alarm_id = "no_heartbeat/data_acquisition", .until = add_months(time_, 1)});
  EXPECT_FALSE(desk_->apply(shelved, time_));
  EXPECT_THAT(states(), ElementsAre("no_heartbeat/data_acquisition shelved", "overdue test unacknowledged"))
      << "what is out of sight hides nothing else";
  pass(seconds(2));
  EXPECT_THAT(states(), ElementsAre("no_heartbeat/data_acquisition shelved", "overdue test unacknowledged"));
}

TEST_F(Desk, AnAdvisoryThatAnotherReplacesOrSomebodyAnswersIsOverAndOneThatReturnsIsTold) {
  desk_->stand(advice("plan"), time_);
  desk_->stand(advice("book"), time_);
  EXPECT_THAT(states(), ElementsAre("book unacknowledged"));
  desk_->stand({.asset_id = "A", .advice = {}, .is_answered = false}, time_);
  EXPECT_THAT(states(), ElementsAre("book returned"));
  acknowledge("book");
  desk_->stand(advice("replace"), time_);
  desk_->stand({.asset_id = "A", .advice = {}, .is_answered = true}, time_);
  EXPECT_THAT(states(), IsEmpty()) << "the actuator was replaced";
}

TEST_F(Desk, AShelvedAdvisoryThatAsksForItEarlierIsSeenAgain) {
  const std::int64_t due_ns = time_.nanoseconds + 300 * kDay_ns;
  desk_->stand(advice("book", due_ns), time_);
  EXPECT_EQ(apply(kAlarmShelved, "book", UtcTime{time_.nanoseconds + 100 * kDay_ns}), "");
  desk_->stand(advice("book", due_ns), time_);
  desk_->stand(advice("book", due_ns + kDay_ns), time_);
  EXPECT_THAT(states(), ElementsAre("book shelved"));
  desk_->stand(advice("book", due_ns - kDay_ns), time_);
  EXPECT_THAT(states(), ElementsAre("book unacknowledged"));
}

TEST_F(Desk, WhatOnlyAnActEndsNeedsNoOtherAct) {
  const ServiceAlarm set_aside{
      .kind = "set_aside", .asset_id = "A", .subject = "x", .pst_id = {}, .text = {}, .since_ns = 1};
  pass(seconds(2), {set_aside});
  pass(seconds(15));
  EXPECT_THAT(states(), IsEmpty()) << "somebody had it tried again";
}

TEST_F(Desk, StrangersFillNeitherMemoryNorHeartbeat) {
  for (int k = 0; k < 3000; ++k) {
    ServiceStatus status;
    status.service = "state_detection";
    status.alarms = {lost(std::to_string(k)), lost(std::string(5000, 'x'))};
    status.alarm_count = 2;
    steady_ += seconds(20);
    desk_->hear(status, steady_, time_);
    status.service = "not one of ours";
    desk_->hear(status, steady_, time_);
  }
  ServiceStatus told;
  desk_->tell(told, time_);
  EXPECT_LE(told.desk_count, 2 * AlarmDesk::kMostOfAKind + 1);
  EXPECT_THAT(told.desk, SizeIs(AlarmDesk::kMostTold));
  EXPECT_LT(told.desk_count, 600U);
}

/// One neighbour lacks what another has: they come in any order.
TEST_F(Desk, OfActsThatAreFetchedBackTheLastSaidCounts) {
  pass(seconds(2), {lost("flow")});
  const AlarmAct shelf{.alarm_id = "sensor_lost/flow", .until = add_seconds(time_, 600.0)};
  const AlarmAct unshelf{.alarm_id = "sensor_lost/flow", .until = {}};
  const auto at = [&](std::string_view kind, const AlarmAct& act, double when_s) {
    return event(kind, "A", act, add_seconds(kNoon, when_s));
  };
  std::vector<MaintenanceEvent> acts = {at(kAlarmShelved, shelf, -40.0), at(kAlarmUnshelved, unshelf, -30.0),
                                        at(kAssetOutOfService, {}, -40.0), at(kAssetInService, {}, -30.0)};
  const auto before = [](const auto& a, const auto& b) { return a.header.message_id < b.header.message_id; };
  std::ranges::sort(acts, before);
  do {
    RecalledAlarmActs recalled;
    for (const MaintenanceEvent& act : acts) {
      recalled.add(act);
      recalled.decide(*desk_, time_);
    }
    EXPECT_THAT(states(), ElementsAre("sensor_lost/flow unacknowledged"));
    EXPECT_THAT(recalled.take_decided(), SizeIs(4));
  } while (std::ranges::next_permutation(acts, before).found);
}

TEST_F(Desk, AShelfThatIsFetchedBackWaitsForItsAlarmToItsEnd) {
  RecalledAlarmActs recalled;
  recalled.add(event(kAlarmShelved, "A", {.alarm_id = "sensor_lost/flow", .until = add_seconds(time_, 60.0)}));
  recalled.add(event(kAlarmShelved, "A", {.alarm_id = "sensor_lost/position", .until = add_seconds(time_, 60.0)}));
  pass(seconds(20));
  recalled.decide(*desk_, time_);
  EXPECT_FALSE(recalled.has_decided());
  pass(seconds(20), {lost("flow")});
  recalled.decide(*desk_, time_);
  EXPECT_THAT(states(), ElementsAre("sensor_lost/flow shelved"));
  EXPECT_THAT(recalled.take_decided(), SizeIs(1));
  pass(seconds(30), {lost("flow")});
  recalled.decide(*desk_, time_);
  EXPECT_THAT(recalled.take_decided().at(0).why_not.value_or(""), HasSubstr("there is no alarm"));
}

/// Who acknowledged it since is not told to be somebody else.
TEST_F(Desk, AnAcknowledgementThatIsFetchedBackTakesNobodysPlace) {
  pass(seconds(2), {lost("flow")});
  acknowledge("sensor_lost/flow");
  Acknowledgement earlier;
  earlier.asset_id = "A";
  earlier.advisory_id = "sensor_lost/flow";
  earlier.acknowledged_by = "somebody else";
  earlier.header.event_time_known = true;
  earlier.header.event_time_ns = 2;
  RecalledAlarmActs recalled;
  recalled.add(earlier);
  recalled.decide(*desk_, time_);
  EXPECT_EQ(recalled.take_decided().at(0).why_not, "it is acknowledged already, by M. Okoye");
  EXPECT_EQ(desk_->entry_of("A", "sensor_lost/flow")->acknowledged_by, "M. Okoye");
}

TEST(AlarmActs, SayInTheirIdWhatTheyMean) {
  const UtcTime until = parse_utc("2031-06-01T00:00:00Z").value();
  for (const std::string asset : {"", "A", "field/A"}) {
    const AlarmAct shelf{.alarm_id = "advice/recommendation/x/y", .until = until};
    const auto read = alarm_act_of(event(kAlarmShelved, asset, shelf));
    ASSERT_TRUE(read.has_value()) << asset;
    EXPECT_EQ(read->alarm_id, shelf.alarm_id);
    EXPECT_EQ(read->until, until);
    EXPECT_TRUE(alarm_act_of(event(kAssetOutOfService, asset, {})).has_value());
    EXPECT_FALSE(alarm_act_of(event(kAssetOutOfService, asset, shelf)).has_value());
    EXPECT_FALSE(alarm_act_of(event(kAlarmUnshelved, asset, {})).has_value());
    EXPECT_FALSE(alarm_act_of(event(kAlarmShelved, asset, {.alarm_id = "x", .until = {}})).has_value());
  }
}

/// The layer that keeps alarms; it sees what people say that is not for the desk.
class KeepingLayer final : public Layer {
 public:
  [[nodiscard]] std::string_view name() const override { return "advisory_generation"; }
  [[nodiscard]] std::span<const Topic> inputs() const override { return kInputs; }
  [[nodiscard]] std::span<const Topic> outputs() const override { return kOutputs; }
  void restore(const Message& /*own*/) override {}
  [[nodiscard]] Conclusion receive(const Message& input) override {
    Advisory advisory;
    advisory.asset_id = asset_of(input);
    advisory.header = header("advisory/" + header_of(input).message_id, "");
    return {{advisory}, {header_of(input).message_id}};
  }

 private:
  static constexpr std::array kInputs = {Topic::acknowledgement, Topic::maintenance_event};
  static constexpr std::array kOutputs = {Topic::advisory};
};

/// The desk in its service, on a bus with one who speaks for state detection and for people.
class DeskInService : public ::testing::Test {
 protected:
  std::unique_ptr<Process> start(bool keeps_alarms = true) {
    RunnerOptions options = fast_options();
    options.version = "under test";
    if (keeps_alarms)
      options.desk = AlarmDesk::Options{.service = "advisory_generation", .services = {"state_detection"}};
    auto process = std::make_unique<Process>(
        network_, [] { return std::make_unique<KeepingLayer>(); }, place_.connection(), Fate(), std::move(options));
    process->start();
    process->clock().set(kNoon);
    return process;
  }
  void beat() {
    ServiceStatus status;
    status.service = "state_detection";
    status.writer_id = "state_detection-1";
    status.alarms = {lost("flow")};
    status.alarm_count = 1;
    EXPECT_TRUE(others_.publish(status));
  }
  /// Steps until the service says of its alarms what is asked for.
  ::testing::AssertionResult says(Process& process, const std::vector<std::string>& states) {
    std::vector<std::string> said;
    const bool done = step_until(
        [&] {
          beat();
          for (const BusItem& item : others_.receive(std::chrono::milliseconds(5), 1000))
            if (const auto* status = std::get_if<ServiceStatus>(&item); status && status->version == "under test") {
              said.clear();
              for (const AlarmEntry& one : status->desk)
                said.push_back(alarm_id(one.alarm) + " " + std::string(name_of(state_of(one, process.clock().now()))));
            }
          return said == states;
        },
        [&] { process.step(); });
    return done ? ::testing::AssertionSuccess() : ::testing::AssertionFailure() << ::testing::PrintToString(said);
  }
  std::vector<std::string> acts() {
    std::vector<std::string> said;
    const auto trail = read_audit_trail(place_.connection(), "advisory_generation").value();
    for (const AuditEntry& one : trail) said.push_back(one.act.kind + " by " + one.act.who + ": " + one.act.outcome);
    return said;
  }
  void say(Process& process, const Message& message) {
    EXPECT_TRUE(others_.publish(message));
    for (int k = 0; k < 5; ++k) process.step();
  }

  Place place_;
  std::shared_ptr<InMemoryNetwork> network_ = std::make_shared<InMemoryNetwork>();
  InMemoryBus others_{network_};
};

TEST_F(DeskInService, ActsAreRecordedSurviveARestartAndConcludeNothing) {
  EXPECT_TRUE(others_.subscribe_service_topics());
  const AlarmAct shelf{.alarm_id = "sensor_lost/flow", .until = add_seconds(kNoon, 3600.0)};
  {
    const auto process = start();
    ASSERT_TRUE(says(*process, {"sensor_lost/flow unacknowledged"}));
    say(*process, event(kAlarmShelved, "A", shelf));
    ASSERT_TRUE(says(*process, {"sensor_lost/flow shelved"}));
    say(*process, event(kAlarmShelved, "B", shelf));
    EXPECT_TRUE(process->outputs().empty()) << "the layer was told nothing";
  }
  const auto process = start();
  ASSERT_TRUE(says(*process, {"sensor_lost/flow shelved"}));
  Acknowledgement seen;
  seen.asset_id = "A";
  seen.advisory_id = "sensor_lost/flow";
  seen.acknowledged_by = "M. Okoye";
  seen.header = header("acknowledgement/sensor_lost/1", "");
  say(*process, seen);
  process->clock().set(add_seconds(kNoon, 3601.0));
  EXPECT_TRUE(says(*process, {"sensor_lost/flow acknowledged"}));
  EXPECT_TRUE(process->outputs().empty());
  EXPECT_THAT(acts(), ElementsAre("alarm_shelved by J. Silva: taken",
                                  "alarm_shelved by J. Silva: there is no alarm 'sensor_lost/flow' of B",
                                  "acknowledgement by M. Okoye: taken"));
}

/// Nobody would have seen it, and who did before would be forgotten.
TEST_F(DeskInService, NobodyAcknowledgesOrSetsAsideWithoutAName) {
  EXPECT_TRUE(others_.subscribe_service_topics());
  const auto process = start();
  ASSERT_TRUE(says(*process, {"sensor_lost/flow unacknowledged"}));
  Acknowledgement seen;
  seen.asset_id = "A";
  seen.advisory_id = "sensor_lost/flow";
  seen.acknowledged_by = "M. Okoye";
  seen.header = header("acknowledgement/sensor_lost/1", "");
  say(*process, seen);
  seen.header.message_id = "acknowledgement/sensor_lost/2";
  seen.acknowledged_by = " \u00a0";
  say(*process, seen);
  seen.header.message_id = "acknowledgement/sensor_lost/3";
  seen.acknowledged_by.clear();
  say(*process, seen);
  MaintenanceEvent shelf =
      event(kAlarmShelved, "A", {.alarm_id = "sensor_lost/flow", .until = add_seconds(kNoon, 60.0)});
  shelf.reported_by.clear();
  say(*process, shelf);
  EXPECT_TRUE(says(*process, {"sensor_lost/flow acknowledged"}));
  EXPECT_THAT(acts(), ElementsAre("acknowledgement by M. Okoye: taken", HasSubstr("does not say who"),
                                  HasSubstr("does not say who"), HasSubstr("does not say who")));
}

TEST_F(DeskInService, AServiceWithoutTheDeskGivesItsLayerNoneOfIt) {
  const auto process = start(false);
  say(*process, event(kAssetOutOfService, "A", {}));
  EXPECT_TRUE(process->outputs().empty());
  EXPECT_THAT(acts(), IsEmpty()) << "it is the other service's to record";
}

}  // namespace
}  // namespace sealwatch::testing
