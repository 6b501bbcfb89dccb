// What people tell a service stands in its audit trail: what was taken, once, and what was refused.
#include "services/common/runtime/operator_acts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>

#include "sealwatch/message/confirmation.hpp"
#include "sealwatch/message/replacement_id.hpp"
#include "sealwatch/port/accepted_model.hpp"
#include "services/common/runtime/identity.hpp"
#include "services/common/store/journal.hpp"
#include "services/common/store/quarantine_desk.hpp"
#include "tests/unit/runtime/harness.hpp"

namespace sealwatch::testing {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// Concludes from what people say that it was said.
class ListeningLayer final : public Layer {
 public:
  [[nodiscard]] std::string_view name() const override { return "advisory_generation"; }
  [[nodiscard]] std::span<const Topic> inputs() const override { return kInputs; }
  [[nodiscard]] std::span<const Topic> outputs() const override { return kOutputs; }
  void restore(const Message& /*own*/) override {}
  [[nodiscard]] Conclusion receive(const Message& input) override {
    if (const auto* acceptance = std::get_if<ModelAcceptance>(&input); acceptance && acceptance->remark == "forged")
      return {.outputs = {},
              .consumed = {header_of(input).message_id},
              .later = {},
              .refused = {{.input = input, .reason = "its model is another"}}};
    Advisory advisory;
    advisory.asset_id = asset_of(input);
    advisory.header = header("advisory/" + header_of(input).message_id, "");
    return {{advisory}, {header_of(input).message_id}};
  }

 private:
  static constexpr std::array kInputs = {Topic::acknowledgement, Topic::maintenance_event, Topic::model_acceptance};
  static constexpr std::array kOutputs = {Topic::advisory};
};

class ActsTest : public ::testing::Test {
 protected:
  std::unique_ptr<Process> start(RunnerOptions options = fast_options()) {
    auto process = std::make_unique<Process>(
        network_, [] { return std::make_unique<ListeningLayer>(); }, place_.connection(), Fate(), std::move(options));
    process->start();
    return process;
  }
  void say(Process& process, const Message& message) {
    EXPECT_TRUE(operator_.publish(message));
    for (int k = 0; k < 5; ++k) process.step();
  }
  std::vector<AuditEntry> acts() { return read_audit_trail(place_.connection(), "advisory_generation").value(); }

  Place place_;
  std::shared_ptr<InMemoryNetwork> network_ = std::make_shared<InMemoryNetwork>();
  InMemoryBus operator_{network_};
};

Acknowledgement seen(const std::string& who) {
  Acknowledgement message;
  message.asset_id = "A";
  message.header = header("acknowledgement/x/1", "");
  message.advisory_id = "x";
  message.acknowledged_by = who;
  message.remark = "booked";
  return message;
}

MaintenanceEvent replaced(const std::string& who, UtcTime at) {
  MaintenanceEvent event;
  event.asset_id = "A";
  event.kind = "seal_replaced";
  event.reported_by = who;
  event.header = header("maintenance_event/A/" + format_utc(at), "");
  event.header.event_time_known = true;
  event.header.event_time_ns = at.nanoseconds;
  return event;
}

/// Concludes from each test, and from what people say of it, that it came.
class TestsAndActsLayer final : public Layer {
 public:
  [[nodiscard]] std::string_view name() const override { return "advisory_generation"; }
  [[nodiscard]] std::span<const Topic> inputs() const override { return kInputs; }
  [[nodiscard]] std::span<const Topic> outputs() const override { return kOutputs; }
  void restore(const Message& /*own*/) override {}
  [[nodiscard]] Conclusion receive(const Message& input) override {
    Advisory advisory;
    advisory.asset_id = asset_of(input);
    advisory.header = header("advisory/" + header_of(input).message_id, header_of(input).pst_id);
    return {{advisory}, {header_of(input).message_id}};
  }

 private:
  static constexpr std::array kInputs = {Topic::health_report, Topic::maintenance_event};
  static constexpr std::array kOutputs = {Topic::advisory};
};

/// Keeps accepted models, and nothing else.
class AcceptingLayer final : public Layer {
 public:
  [[nodiscard]] std::string_view name() const override { return "advisory_generation"; }
  [[nodiscard]] std::span<const Topic> inputs() const override { return kInputs; }
  [[nodiscard]] std::span<const Topic> outputs() const override { return kOutputs; }
  void restore(const Message& /*own*/) override {}
  [[nodiscard]] Conclusion receive(const Message& input) override {
    Conclusion conclusion;
    if (const auto* published = std::get_if<ModelDiscrepancy>(&input)) accepted_.take(*published, conclusion);
    if (const auto* acceptance = std::get_if<ModelAcceptance>(&input)) accepted_.take(*acceptance, conclusion);
    return conclusion;
  }
  [[nodiscard]] std::size_t held() const override { return accepted_.held(); }
  [[nodiscard]] std::vector<Refusal> waiting() const override { return accepted_.waiting(); }

 private:
  static constexpr std::array kInputs = {Topic::model_discrepancy, Topic::model_acceptance};
  static constexpr std::array kOutputs = {Topic::advisory};
  AcceptedModel accepted_;
};

/// It waited as if it counted, and nobody knew for an hour.
TEST_F(ActsTest, AModelThatNoServicePublishedIsAnAlarmUntilOneDoes) {
  RunnerOptions options = fast_options();
  options.records_wait = std::chrono::milliseconds(50);
  const auto begin = [&] {
    auto started = std::make_unique<Process>(
        network_, [] { return std::make_unique<AcceptingLayer>(); }, place_.connection(), Fate(), options);
    started->start();
    return started;
  };
  auto process = begin();
  InMemoryBus listener(network_);
  ASSERT_TRUE(listener.subscribe_service_topics());
  const auto told = [&](bool is_told) {
    return step_until(
        [&] {
          process->step();
          bool found = !is_told;
          for (const BusItem& item : listener.receive(std::chrono::milliseconds(5), 1000))
            if (const auto* status = std::get_if<ServiceStatus>(&item))
              found = std::ranges::any_of(status->alarms, [](const ServiceAlarm& alarm) {
                return alarm.kind == "unpublished_model" && alarm.subject == "model_acceptance/A/1" &&
                       alarm.text.find("model_discrepancy/A-7") != std::string::npos;
              });
          return found == is_told;
        },
        [] {});
  };
  ModelAcceptance acceptance;
  acceptance.asset_id = "A";
  acceptance.header = header("model_acceptance/A/1", "");
  acceptance.discrepancy_id = "model_discrepancy/A-7";
  acceptance.accepted_by = "J. Silva";
  acceptance.explained.model = "eha";
  say(*process, acceptance);
  EXPECT_TRUE(told(true));
  ASSERT_THAT(acts(), SizeIs(1));
  EXPECT_EQ(acts()[0].act.outcome, kTakenAndWaits);
  process.reset();
  process = begin();
  EXPECT_TRUE(told(true)) << "after a restart";
  ModelDiscrepancy published;
  published.asset_id = "A";
  published.header = header("model_discrepancy/A-7", "");
  published.version = acceptance.version;
  published.header.event_time_ns = acceptance.discrepancy_time_ns;
  published.analysed = true;
  published.verdict = DiscrepancyVerdict::mismatch;
  published.physics = {{}};
  published.explained = acceptance.explained;
  say(*process, published);
  EXPECT_TRUE(told(false));
  EXPECT_THAT(acts(), SizeIs(1)) << "it is not refused";
  acceptance.header = header("model_acceptance/A/2", "");
  say(*process, acceptance);
  EXPECT_EQ(acts().back().act.outcome, kTaken);
}

/// Whoever lost its journal while all were down goes on under another name, and must learn what it has lost.
TEST_F(ActsTest, WhatWasReadOfASilentNeighbourIsToldAfterARestart) {
  InMemoryBus listener(network_);
  ASSERT_TRUE(listener.subscribe_service_topics());
  const auto start_reader = [this] {
    auto process = std::make_unique<Process>(
        network_, [] { return std::make_unique<TestsAndActsLayer>(); }, place_.connection());
    process->start();
    return process;
  };
  auto process = start_reader();
  HealthReport report;
  report.asset_id = "A";
  report.header = header("health_report/A-1", "A-1");
  report.header.writer_id = "health_assessment-lost";
  report.header.stream_sequence = 1;
  say(*process, report);
  process.reset();
  (void)listener.receive(std::chrono::milliseconds(1), 1000);
  process = start_reader();
  std::vector<StreamPosition> received;
  EXPECT_TRUE(step_until(
      [&] {
        for (const BusItem& item : listener.receive(std::chrono::milliseconds(5), 1000))
          if (const auto* status = std::get_if<ServiceStatus>(&item)) received = status->received;
        return !received.empty();
      },
      [&] { process->step(); }));
  EXPECT_EQ(received, (std::vector<StreamPosition>{{"health_report", "health_assessment-lost", 1}}));
}

class EarlyRetractionTest : public ActsTest {
 protected:
  EarlyRetractionTest() {
    start_anew();
    for (std::size_t k = 0; k < kMostIdleRetractions; ++k) say(*process_, retracted("none" + std::to_string(k)));
    EXPECT_TRUE(
        step_until([this] { return concluded().size() == kMostIdleRetractions; }, [this] { process_->step(); }));
  }
  void start_anew() {
    process_.reset();
    RunnerOptions options = fast_options();
    options.longest_without_acts = std::chrono::milliseconds(0);
    process_ = std::make_unique<Process>(
        network_, [] { return std::make_unique<TestsAndActsLayer>(); }, place_.connection(), Fate(), options);
    process_->start();
  }
  MaintenanceEvent act(std::string_view kind, const std::string& what) {
    MaintenanceEvent event = replaced("J. Silva", process_->clock().now());
    event.kind = kind;
    event.header.message_id = retraction_id("A", kind, what, process_->clock().now());
    return event;
  }
  MaintenanceEvent retracted(const std::string& pst_id) { return act(kTestRetracted, pst_id); }
  static Message test_of(const std::string& pst_id) {
    HealthReport report;
    report.asset_id = "A";
    report.header = header("health_report/" + pst_id, pst_id);
    return report;
  }
  std::vector<std::string> concluded() {
    std::vector<std::string> ids;
    for (const Message& output : process_->outputs()) ids.push_back(header_of(output).message_id.substr(9));
    return ids;
  }
  std::vector<std::string> concluded_since() {
    auto ids = concluded();
    ids.erase(ids.begin(), ids.begin() + kMostIdleRetractions);
    return ids;
  }
  bool steps_until_outcome(const std::string& text) {
    return step_until([&] { return acts().back().act.outcome.find(text) != std::string::npos; },
                      [this] { process_->step(); });
  }
  /// Whether so many conclusions come; those from acts that waited come some steps later.
  bool concludes(std::size_t count) {
    return step_until([&] { return concluded_since().size() >= count; }, [this] { process_->step(); });
  }
  std::unique_ptr<Process> process_;
};

/// A service that is behind has not heard of a test that others know, and retractions of no test stand there in plenty.
TEST_F(EarlyRetractionTest, OfATestThatIsNotHeardOfYetCountsOnceItComes) {
  const Message early = retracted("behind");
  say(*process_, early);
  EXPECT_EQ(acts().back().act.outcome.find("refused"), std::string::npos) << acts().back().act.outcome;
  EXPECT_THAT(concluded_since(), IsEmpty()) << "nothing is concluded from what means nothing";
  start_anew();
  say(*process_, test_of("another"));
  EXPECT_THAT(concluded_since(), ElementsAre("health_report/another"));
  say(*process_, test_of("behind"));
  EXPECT_TRUE(concludes(3));
  EXPECT_THAT(concluded_since(),
              ElementsAre("health_report/another", "health_report/behind", header_of(early).message_id));
  EXPECT_EQ(acts().back().act.outcome, "taken");
  EXPECT_EQ(acts().back().act.subject, header_of(early).message_id);
  say(*process_, early);
  EXPECT_THAT(concluded_since(), SizeIs(3)) << "the same message again";
}

TEST_F(EarlyRetractionTest, ThatIsWithdrawnIsSoOnceItsTestComes) {
  const Message early = retracted("behind");
  const Message withdrawn = act(kRetractionWithdrawn, header_of(early).message_id);
  say(*process_, withdrawn);
  say(*process_, early);
  say(*process_, test_of("behind"));
  say(*process_, test_of("later"));
  EXPECT_TRUE(concludes(4));
  EXPECT_THAT(concluded_since(),
              ::testing::UnorderedElementsAre("health_report/behind", header_of(early).message_id,
                                              header_of(withdrawn).message_id, "health_report/later"));
}

TEST_F(EarlyRetractionTest, SoManyWaitAndLaterOnesAreRefused) {
  const MaintenanceEvent early = retracted("behind");
  say(*process_, early);
  for (int k = 0; k < 8; ++k) say(*process_, retracted("invented" + std::to_string(k)));
  EXPECT_THAT(acts().back().act.outcome, HasSubstr("8 such ones of asset A wait already"));
  EXPECT_THAT(concluded_since(), IsEmpty());
  say(*process_, test_of("behind"));
  EXPECT_TRUE(concludes(2));
  EXPECT_THAT(concluded_since(), ElementsAre("health_report/behind", early.header.message_id));
}

/// Whoever names a test that never comes would have it waited for in vain, and others kept from waiting.
TEST_F(EarlyRetractionTest, WaitsForAnHourAndCanBeSaidAgain) {
  for (const bool is_restarted : {false, true}) {
    const std::string test = is_restarted ? "late-2" : "late-1";
    const Message early = retracted(test);
    say(*process_, early);
    const UtcTime later = add_seconds(process_->clock().now(), 3700.0);
    if (is_restarted) start_anew();
    process_->clock().set(later);
    EXPECT_TRUE(steps_until_outcome("what it means did not come within 60 minutes"));
    say(*process_, test_of(test));
    EXPECT_EQ(concluded().back(), "health_report/" + test) << "it counts no more";
    say(*process_, early);
    EXPECT_EQ(concluded().back(), header_of(early).message_id) << "said again, it counts";
  }
}

/// Killed when the test was known, and before the act was given.
TEST_F(EarlyRetractionTest, CountsAfterAKillBetweenTheTwo) {
  const Message early = retracted("behind");
  say(*process_, early);
  EXPECT_TRUE(operator_.publish(test_of("behind")));
  process_->step();
  start_anew();
  EXPECT_TRUE(concludes(2));
  EXPECT_THAT(concluded_since(), ElementsAre("health_report/behind", header_of(early).message_id));
}

TEST_F(ActsTest, EachIsRecordedOnceWithWhoAndWhat) {
  const auto process = start();
  say(*process, seen("J. Silva"));
  say(*process, seen("J. Silva"));  // the same message again
  say(*process, replaced("M. Okoye", add_months(process->clock().now(), -1.0)));
  ModelAcceptance acceptance;
  acceptance.asset_id = "A";
  acceptance.header = header("model_acceptance/A/1", "");
  acceptance.discrepancy_id = "model_discrepancy/7";
  acceptance.accepted_by = "R. Engineer";
  acceptance.revoked = true;
  say(*process, acceptance);
  ASSERT_THAT(acts(), SizeIs(3));
  EXPECT_EQ(acts()[0].act.who, "J. Silva");
  EXPECT_EQ(acts()[0].act.kind, "acknowledgement");
  EXPECT_EQ(acts()[0].act.subject, "acknowledgement/x/1");
  EXPECT_EQ(acts()[0].act.text, "booked");
  EXPECT_EQ(acts()[0].act.at, process->clock().now());
  EXPECT_EQ(acts()[1].act.kind, "seal_replaced");
  EXPECT_EQ(acts()[1].act.who, "M. Okoye");
  EXPECT_EQ(acts()[2].act.kind, "model_revoked");
  EXPECT_THAT(acts()[2].act.text, HasSubstr("model_discrepancy/7"));
  EXPECT_FALSE(find_break("advisory_generation", acts()));
}

/// As a maintenance system reports it, by ids of its own or by none: what stands in the record can be taken back.
TEST_F(ActsTest, AReplacementUnderAForeignIdIsKnownByItsKindAndTime) {
  const auto process = start();
  const UtcTime at = add_months(process->clock().now(), -1.0);
  MaintenanceEvent event = replaced("CMMS", at);
  for (const std::string own : {"cmms-4711", "", "maintenance_event/7"}) {
    event.header.message_id = own;
    say(*process, event);
    say(*process, event);  // the same message again
    ASSERT_FALSE(acts().empty());
    const std::string id = acts().back().act.subject;
    EXPECT_EQ(time_of_replacement(id), at) << id;
    EXPECT_TRUE(may_report(id, "A", "seal_replaced")) << id;
    EXPECT_THAT(id, HasSubstr(own));
  }
  EXPECT_THAT(acts(), SizeIs(3));
  MaintenanceEvent withdrawn = replaced("J. Silva", process->clock().now());
  withdrawn.kind = kRetractionWithdrawn;
  withdrawn.header.message_id =
      retraction_id("A", kRetractionWithdrawn, acts().front().act.subject, process->clock().now());
  say(*process, withdrawn);
  EXPECT_EQ(acts().back().act.outcome, "taken");
}

TEST_F(ActsTest, ReplacementsUnderAnIdThatIsAnotherAssetsAreTakenEach) {
  const auto process = start();
  Acknowledgement other = seen("J. Silva");
  other.header.message_id = "cmms-1";
  say(*process, other);
  for (const double months : {-2.0, -1.0}) {
    const UtcTime at = add_months(process->clock().now(), months);
    MaintenanceEvent event = replaced("CMMS", at);
    event.asset_id = "B";
    event.header.message_id = "cmms-1";
    say(*process, event);
    EXPECT_EQ(time_of_replacement(acts().back().act.subject), at) << acts().back().act.subject;
  }
  EXPECT_THAT(acts(), SizeIs(3));
}

/// Earlier versions kept a replacement as it came. After the update its sender's last message comes again, as all that
/// are retained do: it is the one that is known, and restarts no history.
TEST_F(ActsTest, AReplacementThatAnEarlierVersionKeptIsNotTakenAgain) {
  const UtcTime at = parse_utc("2020-05-01T00:00:00Z").value();
  MaintenanceEvent event = replaced("CMMS", at);
  event.header.message_id.clear();
  const EarlierInputs none{.has = [](const std::string&) { return false; },
                           .last_unnumbered = [](Topic, const std::string&) { return std::string(); }};
  const std::string begin = "maintenance_event/A/seal_replaced/", now = identify(event, none).value();
  ASSERT_TRUE(now.starts_with(begin));
  const std::string hash = now.substr(begin.size(), now.find('/', begin.size()) - begin.size());
  const std::string as_it_was_named = "maintenance_event/A/" + hash;
  for (const std::string& id : {std::string("cmms-4711"), as_it_was_named}) {
    auto journal = Journal::open(place_.connection(), "advisory_generation");
    MaintenanceEvent kept = event;
    kept.header.message_id = id;
    ASSERT_TRUE(journal->begin());
    ASSERT_TRUE(journal->add_input(kept, at, true));
    ASSERT_TRUE(journal->commit());
  }
  const auto process = start();
  say(*process, event);
  event.header.message_id = "cmms-4711";
  say(*process, event);
  EXPECT_THAT(acts(), IsEmpty());
}

/// Each service tells its last entry, and keeps what others tell: who cuts off an end would have to cut all.
TEST_F(ActsTest, TheEndOfTheRecordIsToldAndThatOfOthersIsKept) {
  const auto process = start();
  say(*process, seen("J. Silva"));
  ServiceStatus told;
  ASSERT_TRUE(operator_.subscribe_service_topics());
  const auto is_told = [&] {
    process->step();
    for (const BusItem& item : operator_.receive(std::chrono::milliseconds(1), 100))
      if (const auto* status = std::get_if<ServiceStatus>(&item)) told = *status;
    return std::ranges::find(told.written, kActsTopic, &StreamPosition::topic) != told.written.end();
  };
  ASSERT_TRUE(step_until(is_told, [] {}));
  EXPECT_EQ(*std::ranges::find(told.written, kActsTopic, &StreamPosition::topic),
            (StreamPosition{kActsTopic, acts().back().hash, 1}));
  ServiceStatus other;
  other.service = "state_detection";
  other.writer_id = "state_detection-1";
  other.state = "running";
  for (const std::uint64_t length : {3U, 3U, 2U}) {
    other.written = {{kActsTopic, std::string(64, static_cast<char>('0' + length)), length}};
    ASSERT_TRUE(operator_.publish(other));
    process->step();
  }
  std::vector<AuditAnchor> heard;
  const auto is_kept = [&] {
    heard = read_audit_anchors(place_.connection(), "advisory_generation").value().heard;
    return heard.size() == 2;
  };
  ASSERT_TRUE(step_until(is_kept, [&] { process->step(); }));
  EXPECT_EQ(heard[0], (AuditAnchor{"state_detection", 2, std::string(64, '2')}));
  EXPECT_EQ(heard[1], (AuditAnchor{"state_detection", 3, std::string(64, '3')}));
}

/// A neighbour whose record of acts has so many entries.
ServiceStatus with_acts(std::uint64_t count) {
  ServiceStatus status;
  status.service = "state_detection";
  status.writer_id = "state_detection-1";
  status.state = "running";
  if (count > 0) status.written = {{kActsTopic, std::string(64, '1'), count}};
  return status;
}

class LostJournal : public ActsTest {
 protected:
  void SetUp() override { ASSERT_TRUE(operator_.subscribe_service_topics()); }
  void hear(Process& process, const ServiceStatus& status) {
    EXPECT_TRUE(operator_.publish(status));
    step_for(std::chrono::milliseconds(1100), [&] { process.step(); });  // acts are looked at each second
  }
  /// Texts of the alarms of the last heartbeat.
  std::vector<std::string> alarms() {
    std::vector<std::string> texts;
    for (const BusItem& item : operator_.receive(std::chrono::milliseconds(100), 1'000'000))
      if (const auto* status = std::get_if<ServiceStatus>(&item);
          status != nullptr && status->service == "advisory_generation") {
        texts.clear();
        for (const ServiceAlarm& alarm : status->alarms) texts.push_back(alarm.subject + ": " + alarm.text);
      }
    return texts;
  }
  void lose() {
    for (const auto& entry : std::filesystem::directory_iterator(place_.directory()))
      std::filesystem::remove_all(entry.path());
  }
};

/// Who retracted a test has gone home: in this service alone it would count again, and nobody would know.
TEST_F(LostJournal, IsAnAlarmWhereOthersHaveARecordOfActsUntilSomebodySaysThemAgain) {
  auto process = start();
  say(*process, seen("J. Silva"));
  process.reset();
  lose();
  process = start();
  hear(*process, with_acts(1));
  const auto is_told = ElementsAre(AllOf(HasSubstr("journal/advisory_generation: the journal was lost"),
                                         HasSubstr("state_detection has a record"), HasSubstr("retract")));
  EXPECT_THAT(alarms(), is_told);
  process.reset();
  process = start();
  hear(*process, with_acts(1));
  EXPECT_THAT(alarms(), is_told) << "a restart ends nothing";
  ASSERT_TRUE(QuarantineDesk::open(place_.connection(), "advisory_generation")
                  ->ask_again("journal/advisory_generation", "J. Silva", process->clock().now())
                  .value());
  hear(*process, with_acts(1));
  EXPECT_THAT(alarms(), IsEmpty());
  process.reset();
  process = start();
  hear(*process, with_acts(2));
  EXPECT_THAT(alarms(), IsEmpty());
}

/// For a minute only the neighbour without a record ran: who has one was started again later.
TEST_F(LostJournal, IsNoticedWheneverTheOneWithARecordIsHeard) {
  RunnerOptions options = fast_options();
  options.strangers.services = {"data_manipulation", "state_detection", "advisory_generation"};
  const auto process = start(options);
  ServiceStatus without = with_acts(0);
  without.service = "data_manipulation";
  without.writer_id = "data_manipulation-1";
  hear(*process, without);
  hear(*process, with_acts(1));
  EXPECT_THAT(alarms(), ElementsAre(HasSubstr("state_detection has a record")));
}

TEST_F(LostJournal, ANewOneWhoseNeighboursAreNewTooIsNone) {
  auto process = start();
  hear(*process, with_acts(0));
  hear(*process, with_acts(1));  // somebody speaks
  EXPECT_THAT(alarms(), IsEmpty());
}

TEST_F(LostJournal, OneThatHasItsOwnRecordIsNone) {
  auto process = start();
  say(*process, seen("J. Silva"));
  process.reset();
  process = start();
  hear(*process, with_acts(3));
  EXPECT_THAT(alarms(), IsEmpty());
}

TEST_F(ActsTest, WhatIsRefusedIsRecordedWithTheReason) {
  const auto process = start();
  say(*process, replaced("M. Okoye", add_months(process->clock().now(), 1.0)));
  ASSERT_THAT(acts(), SizeIs(1));
  EXPECT_THAT(acts()[0].act.outcome, HasSubstr("lies in the future"));
  EXPECT_TRUE(process->outputs().empty());
}

/// The id of an acknowledgement says of which advice it is: anybody can say it first.
TEST_F(ActsTest, WhatIsRefusedTakesNoIdFromWhatIsTrulySaid) {
  auto process = start();
  Acknowledgement too_long = seen("stranger");
  too_long.remark = std::string(4001, 'x');
  const Acknowledgement nameless = seen("");
  for (int k = 0; k < 3; ++k) {
    say(*process, too_long);
    say(*process, nameless);
    process.reset();
    process = start();
  }
  ASSERT_THAT(acts(), SizeIs(2)) << "each once";
  say(*process, seen("J. Silva"));
  ASSERT_THAT(acts(), SizeIs(3));
  EXPECT_EQ(acts()[2].act.outcome, "taken");
  EXPECT_EQ(acts()[2].act.who, "J. Silva");
  EXPECT_THAT(process->outputs(), SizeIs(1));
}

/// Somebody stands for each act, whatever it is.
TEST_F(ActsTest, WhatNobodySaidIsRefused) {
  const auto process = start();
  say(*process, replaced(" ", UtcTime{1'899'000'000'000'000'000}));
  MaintenanceEvent retraction = replaced("", UtcTime{1'899'000'000'000'000'000});
  retraction.kind = kTestRetracted;
  retraction.header.message_id = retraction_id("A", kTestRetracted, "A-1", UtcTime{1'899'000'000'000'000'000});
  say(*process, retraction);
  ASSERT_THAT(acts(), SizeIs(2));
  for (const AuditEntry& entry : acts()) EXPECT_THAT(entry.act.outcome, HasSubstr("does not say who"));
  EXPECT_TRUE(process->outputs().empty());
}

/// A stranger never stops: the record says how often, hardly grows, and a person's act stands in it.
TEST_F(ActsTest, WhatIsRefusedWithoutEndIsCounted) {
  const auto process = start();
  for (int k = 0; k < 64 + 100; ++k) {
    Acknowledgement nameless = seen("");
    nameless.remark = std::to_string(k);
    EXPECT_TRUE(operator_.publish(nameless));
    process->step();
  }
  say(*process, seen("J. Silva"));
  const std::vector<AuditEntry> entries = acts();
  ASSERT_THAT(entries, SizeIs(64 + 7 + 1)) << "at the 1st, 2nd, ..., 64th that is left out";
  EXPECT_EQ(entries[70].act.kind, "refused_acts");
  EXPECT_THAT(entries[70].act.text, HasSubstr("64 more"));
  EXPECT_THAT(entries[70].act.outcome, HasSubstr("does not say who"));
  EXPECT_EQ(entries[71].act.outcome, "taken");
  EXPECT_FALSE(find_break("advisory_generation", entries));
}

/// Well-formed, under a name that anybody can invent: without DDS Security nothing tells them from what is meant.
TEST_F(ActsTest, InventedOnesDoNotFillTheRecordAndAreAnAlarm) {
  ASSERT_TRUE(operator_.subscribe_service_topics());
  const auto process = start();
  const auto invented = [&](int k) {
    Acknowledgement act = seen("Dr. Nobody");
    act.advisory_id = "recommendation/" + std::to_string(k);
    act.header.message_id = "acknowledgement/" + act.advisory_id + "/1";
    ModelAcceptance acceptance;
    acceptance.asset_id = "A";
    acceptance.header = header("model_acceptance/A/" + std::to_string(k), "");
    acceptance.accepted_by = "Dr. Nobody";
    return std::vector<Message>{act, replaced("Dr. Nobody", UtcTime{1'899'000'000'000'000'000 + k}), acceptance};
  };
  for (int k = 0; k < 300; ++k) {
    for (const Message& act : invented(k)) EXPECT_TRUE(operator_.publish(act));
    process->step();
  }
  constexpr std::size_t kKinds = 3;
  EXPECT_THAT(process->outputs(), SizeIs(kKinds * 64));
  EXPECT_THAT(acts(), SizeIs(kKinds * 64 + 64 + 10))
      << "taken of each kind, refused, and at the 1st, ..., 512th left out";
  EXPECT_EQ(acts().back().act.text, "512 more within a day, left out here");
  EXPECT_THAT(acts().back().act.outcome, HasSubstr("64 acts were taken within a day already: "));
  EXPECT_FALSE(find_break("advisory_generation", acts()));
  std::set<std::string> floods;
  (void)step_until(
      [&] {
        for (const BusItem& item : operator_.receive(std::chrono::milliseconds(1), 10'000))
          if (const auto* status = std::get_if<ServiceStatus>(&item))
            for (const ServiceAlarm& alarm : status->alarms)
              if (alarm.kind == "flood") floods.insert(alarm.asset_id + " " + alarm.subject);
        return floods.size() == kKinds;
      },
      [&] { process->step(); });
  EXPECT_THAT(floods, ElementsAre("A acknowledgement", "A model_acceptance", "A seal_replaced"));
  MaintenanceEvent elsewhere = replaced("J. Silva", UtcTime{1'899'000'000'000'000'000});
  elsewhere.asset_id = "B";
  elsewhere.header.message_id = "maintenance_event/B/" + format_utc({1'899'000'000'000'000'000});
  say(*process, elsewhere);
  EXPECT_EQ(acts().back().act.outcome, "taken") << "of another asset";
}

/// Each start would let another 64 of a kind, and of refused ones, into a record that is kept for ever.
TEST_F(ActsTest, ARestartBeginsNoNewDay) {
  const auto invented = [](int k) {
    Acknowledgement of_old_advice = seen("Dr. Nobody");
    of_old_advice.header.message_id = "acknowledgement/x/" + std::to_string(k);
    Acknowledgement nameless = seen("");
    nameless.header.message_id = "acknowledgement/y/" + std::to_string(k);
    return std::vector<Message>{of_old_advice, replaced("Dr. Nobody", UtcTime{1'899'000'000'000'000'000 + k}),
                                nameless};
  };
  const auto flood = [&](Process& process, int first) {
    for (int k = first; k < first + 100; ++k) {
      for (const Message& act : invented(k)) EXPECT_TRUE(operator_.publish(act));
      process.step();
    }
    std::map<std::string, int> full;
    for (const AuditEntry& entry : acts())
      ++full[entry.act.kind == "refused_acts" ? "left out" : entry.act.outcome == "taken" ? entry.act.kind : "refused"];
    return full;
  };
  const std::map<std::string, int> a_day = {{"acknowledgement", 64}, {"seal_replaced", 64}, {"refused", 64}};
  for (int life = 0; life < 3; ++life) {
    auto full = flood(*start(), 100 * life);
    EXPECT_LE(full["left out"], 10 * (life + 1));
    full.erase("left out");
    EXPECT_EQ(full, a_day) << "life " << life;
  }
  Process next_day(
      network_, [] { return std::make_unique<ListeningLayer>(); }, place_.connection());
  next_day.clock().set(add_seconds(next_day.clock().now(), 86'400.0));
  next_day.start();
  EXPECT_EQ(flood(next_day, 300)["seal_replaced"], 2 * 64);
}

TEST_F(ActsTest, OnUnknownAssetsAreRecordedAsRefusedAndDoNotFillTheRecord) {
  RunnerOptions options = fast_options();
  options.assets = {"A"};
  options.refuses_unknown_assets = true;
  options.strangers_stand = std::chrono::milliseconds(0);  // each is told of anew
  const auto process = start(options);
  for (int k = 0; k < 200; ++k) {
    Acknowledgement invented = seen("stranger");
    invented.asset_id = "invented-" + std::to_string(k);
    invented.header.message_id += std::to_string(k);
    EXPECT_TRUE(operator_.publish(invented));
    process->step();
  }
  say(*process, seen("J. Silva"));
  ASSERT_THAT(acts(), SizeIs(64 + 8 + 1)) << "at the 1st, 2nd, ..., 128th that is left out";
  EXPECT_EQ(acts()[0].act.who, "stranger");
  EXPECT_THAT(acts()[0].act.outcome, HasSubstr("asset 'invented-0' is not configured"));
  EXPECT_EQ(acts()[72].act.outcome, "taken");
  EXPECT_THAT(process->outputs(), SizeIs(1));
}

TEST_F(ActsTest, WhatALayerRefusesIsRecordedWithTheReasonAndTold) {
  InMemoryBus listener(network_);
  ASSERT_TRUE(listener.subscribe_service_topics());
  const auto process = start();
  ModelAcceptance acceptance;
  acceptance.asset_id = "A";
  acceptance.header = header("model_acceptance/A/1", "");
  acceptance.accepted_by = "R. Engineer";
  acceptance.remark = "forged";
  say(*process, acceptance);
  ASSERT_THAT(acts(), SizeIs(2));
  EXPECT_EQ(acts()[0].act.outcome, "taken");
  EXPECT_EQ(acts()[1].act.outcome, "its model is another");
  EXPECT_EQ(acts()[1].act.who, "R. Engineer");
  EXPECT_FALSE(find_break("advisory_generation", acts()));
  std::string told;
  EXPECT_TRUE(step_until(
      [&] {
        for (const BusItem& item : listener.receive(std::chrono::milliseconds(5), 1000))
          if (const auto* status = std::get_if<ServiceStatus>(&item)) told = status->last_error;
        return told.find("model_acceptance refused: its model is another") != std::string::npos;
      },
      [&] { process->step(); }))
      << told;
}

/// Where a second person's word is asked for.
class SecondPerson : public ActsTest {
 protected:
  static RunnerOptions asking() {
    RunnerOptions options = fast_options();
    options.acts_confirmed_by_second = true;
    return options;
  }
  MaintenanceEvent confirmation(const Message& act, const std::string& who) {
    MaintenanceEvent event;
    event.asset_id = "A";
    event.kind = kActConfirmed;
    event.reported_by = who;
    const UtcTime when{1'900'000'000'000'000'000 + ++said_};
    event.header = header(confirmation_id("A", header_of(act).message_id, when), "");
    event.header.event_time_known = true;
    event.header.event_time_ns = when.nanoseconds;
    return event;
  }
  const MaintenanceEvent replaced_ = replaced("J. Silva", UtcTime{1'899'000'000'000'000'000});
  int said_ = 0;
};

TEST_F(SecondPerson, NothingComesOfAnActUntilAnotherPersonConfirmsIt) {
  const auto process = start(asking());
  say(*process, replaced_);
  EXPECT_TRUE(process->outputs().empty());
  EXPECT_EQ(process->journal().open_inputs(), 0U) << "it waits for a person, not for the service";
  say(*process, confirmation(replaced_, " j.silva"));
  EXPECT_TRUE(process->outputs().empty()) << "the same person";
  say(*process, confirmation(replaced_, "M. Okoye"));
  ASSERT_THAT(process->outputs(), SizeIs(1));
  EXPECT_EQ(header_of(process->outputs()[0]).message_id, "advisory/" + replaced_.header.message_id);
  EXPECT_EQ(process->journal().open_inputs(), 0U);
  say(*process, confirmation(replaced_, "R. Third"));
  EXPECT_THAT(process->outputs(), SizeIs(1)) << "it counts once";
  ASSERT_THAT(acts(), SizeIs(4));
  EXPECT_THAT(acts()[0].act.outcome, HasSubstr("waits for a second person"));
  EXPECT_THAT(acts()[1].act.outcome, HasSubstr("it takes another person"));
  EXPECT_EQ(acts()[2].act.outcome, "taken");
  EXPECT_THAT(acts()[3].act.outcome, HasSubstr("waits for a confirmation"));
}

TEST_F(SecondPerson, IsNoneByASpaceThatNobodySees) {
  const auto process = start(asking());
  say(*process, replaced_);
  for (const char* const who :
       {"J.\u00a0Silva", "J. Silva\u00a0", "\u200bJ. Silva", "J. Si\u00adlva", "J. Silva\ufeff", " \u3000"})
    say(*process, confirmation(replaced_, who));
  EXPECT_TRUE(process->outputs().empty());
  say(*process, confirmation(replaced_, "M. Okoye"));
  EXPECT_THAT(process->outputs(), SizeIs(1));
}

TEST_F(SecondPerson, ARestartChangesNothing) {
  {
    const auto process = start(asking());
    say(*process, replaced_);
  }
  {
    const auto process = start(asking());
    for (int k = 0; k < 5; ++k) process->step();
    EXPECT_TRUE(process->outputs().empty());
    say(*process, confirmation(replaced_, "M. Okoye"));
    EXPECT_THAT(process->outputs(), SizeIs(1));
  }
  const auto process = start(asking());
  for (int k = 0; k < 5; ++k) process->step();
  EXPECT_THAT(process->outputs(), SizeIs(1));
  EXPECT_EQ(process->journal().open_inputs(), 0U);
}

TEST_F(SecondPerson, WhatIsRejectedNeverCountsAlsoByWhoReportedIt) {
  {
    const auto process = start(asking());
    say(*process, replaced_);
    MaintenanceEvent rejection = confirmation(replaced_, "J. Silva");
    rejection.kind = kActRejected;
    say(*process, rejection);
    say(*process, confirmation(replaced_, "M. Okoye"));
    EXPECT_TRUE(process->outputs().empty());
    EXPECT_EQ(acts()[1].act.kind, "act_rejected");
  }
  const auto process = start(asking());
  say(*process, confirmation(replaced_, "M. Okoye"));
  EXPECT_TRUE(process->outputs().empty());
  EXPECT_TRUE(process->journal().awaiting().value().empty());
}

TEST_F(SecondPerson, WhatWaitsIsAnAlarmFromItsReceiptOn) {
  InMemoryBus listener(network_);
  ASSERT_TRUE(listener.subscribe_service_topics());
  std::vector<ServiceAlarm> alarms;
  auto process = start(asking());
  const auto are = [&](std::size_t count) {
    return step_until(
        [&] {
          for (const BusItem& item : listener.receive(std::chrono::milliseconds(5), 1000))
            if (const auto* status = std::get_if<ServiceStatus>(&item); status && status->state == "running")
              alarms = status->alarms;
          return alarms.size() == count;
        },
        [&] { process->step(); });
  };
  const UtcTime received = process->clock().now();
  say(*process, replaced_);
  ASSERT_TRUE(are(1));
  EXPECT_EQ(alarms[0].kind, "awaits_confirmation");
  EXPECT_EQ(alarms[0].subject, replaced_.header.message_id);
  EXPECT_EQ(alarms[0].since_ns, received.nanoseconds);
  process.reset();
  alarms.clear();
  process = std::make_unique<Process>(
      network_, [] { return std::make_unique<ListeningLayer>(); }, place_.connection(), Fate(), asking());
  process->clock().set(add_seconds(received, 1800.0));
  process->start();
  ASSERT_TRUE(are(1));
  EXPECT_EQ(alarms[0].since_ns, received.nanoseconds) << "a restart does not begin it anew";
  say(*process, confirmation(replaced_, "M. Okoye"));
  EXPECT_TRUE(are(0));
}

TEST_F(SecondPerson, WhatTakesAnActBackAndWhatOnlyLooksCountsAtOnce) {
  const auto process = start(asking());
  say(*process, seen("J. Silva"));
  EXPECT_THAT(process->outputs(), SizeIs(1));
  MaintenanceEvent withdrawn = replaced("J. Silva", process->clock().now());
  withdrawn.kind = kRetractionWithdrawn;
  const std::string retraction = retraction_id("A", kTestRetracted, "A-1", process->clock().now());
  withdrawn.header.message_id = retraction_id("A", kRetractionWithdrawn, retraction, process->clock().now());
  say(*process, withdrawn);
  EXPECT_THAT(process->outputs(), SizeIs(2));
  ModelAcceptance acceptance;
  acceptance.asset_id = "A";
  acceptance.header = header("model_acceptance/A/1", "");
  acceptance.accepted_by = "R. Engineer";
  say(*process, acceptance);
  EXPECT_THAT(process->outputs(), SizeIs(2)) << "an accepted model waits";
  acceptance.revoked = true;
  acceptance.header.message_id = "model_acceptance/A/2";
  say(*process, acceptance);
  EXPECT_THAT(process->outputs(), SizeIs(3));
}

/// Each would be an alarm, and nobody could tell them apart from what is meant.
TEST_F(SecondPerson, OnlySoManyActsOfAnAssetWait) {
  const auto process = start(asking());
  for (int k = 0; k < 10; ++k) say(*process, replaced("M. Okoye", UtcTime{1'899'000'000'000'000'001 + k}));
  EXPECT_THAT(acts().back().act.outcome, HasSubstr("8 acts of asset A wait for a second person already"));
  std::size_t waiting = 0;
  for (const AuditEntry& entry : acts()) waiting += entry.act.outcome == "waits for a second person" ? 1 : 0;
  EXPECT_EQ(waiting, 8U);
  EXPECT_THAT(process->journal().awaiting().value(), SizeIs(8));
  say(*process, confirmation(replaced("M. Okoye", UtcTime{1'899'000'000'000'000'001}), "J. Silva"));
  say(*process, replaced_);
  EXPECT_EQ(acts().back().act.outcome, "waits for a second person");
}

/// What nobody confirms is forgotten: it may be said again, under the same id, and other acts may wait in its place.
TEST_F(SecondPerson, AnActWaitsForAnHourAndCanBeSaidAgain) {
  RunnerOptions options = asking();
  options.longest_without_acts = std::chrono::milliseconds(0);
  auto process = start(options);
  say(*process, replaced_);
  process->clock().set(add_seconds(process->clock().now(), 3601.0));
  say(*process, confirmation(replaced_, "M. Okoye"));
  EXPECT_TRUE(process->outputs().empty()) << "too late";
  const UtcTime later = add_seconds(process->clock().now(), 100.0);
  process.reset();
  process = start(options);
  process->clock().set(later);
  const auto is_told = [&] {
    return acts().back().act.outcome.starts_with("nobody else confirmed it within 60 minutes");
  };
  EXPECT_TRUE(step_until(is_told, [&] { process->step(); })) << acts().back().act.outcome;
  EXPECT_THAT(process->journal().awaiting().value(), IsEmpty());
  say(*process, replaced_);
  say(*process, confirmation(replaced_, "M. Okoye"));
  EXPECT_THAT(process->outputs(), SizeIs(1));
  EXPECT_FALSE(find_break("advisory_generation", acts()));
}

TEST_F(SecondPerson, OneStepIsEnoughWhereNobodyAsksForTwo) {
  const auto process = start();
  say(*process, replaced_);
  EXPECT_THAT(process->outputs(), SizeIs(1));
}

/// Data acquisition as far as people speak to it: it concludes nothing from what they say.
class AcquiringLayer final : public CuttingLayer {
 public:
  [[nodiscard]] std::span<const Topic> inputs() const override { return kInputs; }
  [[nodiscard]] Conclusion receive(const Message& input) override {
    if (topic_of(input) == Topic::raw_samples) return CuttingLayer::receive(input);
    return {{}, {header_of(input).message_id}};
  }

 private:
  static constexpr std::array kInputs = {Topic::raw_samples, Topic::maintenance_event};
};

/// Dates of played-back tests, a year after the newest that counts at most.
class DatesInAcquisition : public ActsTest {
 protected:
  std::unique_ptr<Process> start() {
    auto process = std::make_unique<Process>(
        network_, [] { return std::make_unique<AcquiringLayer>(); }, place_.connection(), Fate(), fast_options());
    process->start();
    return process;
  }
  /// Whether a test of that date is taken.
  bool takes(Process& process, const std::string& date, bool is_replay = true) {
    RawSamples block;
    block.asset_id = "A";
    block.recording_id = "A-" + date;
    block.boundary = BlockBoundary::end;
    block.start_time_known = block.header.event_time_known = true;
    block.start_time_ns = block.header.event_time_ns = parse_utc(date).value().nanoseconds;
    block.header.replay = is_replay;
    block.header.message_id = "raw_samples/" + date + "/" + std::to_string(++sent_);
    const std::size_t before = process.outputs().size();
    say(process, block);
    return process.outputs().size() > before;
  }
  void retract(Process& process, std::string_view kind, const std::string& what) {
    MaintenanceEvent event = replaced("J. Silva", process.clock().now());
    event.kind = kind;
    event.header.message_id = retraction_id("A", kind, what, process.clock().now());
    say(process, event);
    retraction_ = event.header.message_id;
    process.clock().set(add_seconds(process.clock().now(), 60.0));
    now_ = process.clock().now();
  }
  /// The alarms of a heartbeat: "A: text".
  std::vector<std::string> told(const std::unique_ptr<Process>& process) {
    EXPECT_TRUE(operator_.subscribe_service_topics());
    process->step();
    (void)operator_.receive(std::chrono::milliseconds(0), 1'000'000);
    std::vector<std::string> texts;
    for (const BusItem& item : operator_.receive(std::chrono::milliseconds(100), 1))
      if (const auto* status = std::get_if<ServiceStatus>(&item))
        for (const ServiceAlarm& alarm : status->alarms) texts.push_back(alarm.asset_id + ": " + alarm.text);
    return texts;
  }
  int sent_ = 0;
  std::string retraction_;
  UtcTime now_;
};

/// Its blocks count as received: the sender lets go of them, and nobody would look for the test.
TEST_F(DatesInAcquisition, ALiveTestThatIsRefusedIsAnAlarmUntilAGoodOneComes) {
  const auto process = start();
  const UtcTime now = process->clock().now();
  ASSERT_TRUE(takes(*process, format_utc(add_months(now, -3.0)), false));
  EXPECT_FALSE(takes(*process, format_utc(add_months(now, 12.0)), true));
  EXPECT_THAT(told(process), IsEmpty()) << "who plays it back is told";
  EXPECT_FALSE(takes(*process, format_utc(add_months(now, 13.0)), false));
  EXPECT_THAT(told(process), ElementsAre(AllOf(HasSubstr("A: recording A-20"), HasSubstr("lies in the future"))));
  EXPECT_FALSE(takes(*process, format_utc(add_months(now, 14.0)), false));
  EXPECT_THAT(told(process), SizeIs(1));
  EXPECT_TRUE(takes(*process, format_utc(add_months(now, -2.0)), true));
  EXPECT_THAT(told(process), SizeIs(1)) << "played back, it says nothing of the sender";
  EXPECT_TRUE(takes(*process, format_utc(now), false));
  EXPECT_THAT(told(process), IsEmpty());
}

TEST_F(DatesInAcquisition, ARetractedTestIsNotTheNewestAlsoAfterARestart) {
  {
    const auto process = start();
    ASSERT_TRUE(takes(*process, "2045-01-01T00:00:00Z")) << "the first of a history that is played back";
    ASSERT_TRUE(takes(*process, "2045-12-01T00:00:00Z"));
    retract(*process, kTestRetracted, "A-2045-12-01T00:00:00Z");
    EXPECT_FALSE(takes(*process, "2046-11-01T00:00:00Z")) << "more than a year after the newest that counts";
  }
  const auto process = start();
  process->clock().set(now_);
  EXPECT_FALSE(takes(*process, "2046-11-01T00:00:00Z")) << "it is known after a restart";
  retract(*process, kRetractionWithdrawn, retraction_);
  EXPECT_TRUE(takes(*process, "2046-11-01T00:00:00Z"));
}

TEST_F(DatesInAcquisition, AllSinceADateMeansTheTestsThatWereKnownThen) {
  {
    const auto process = start();
    ASSERT_TRUE(takes(*process, "2045-01-01T00:00:00Z"));
    ASSERT_TRUE(takes(*process, "2045-06-01T00:00:00Z"));
    retract(*process, kTestsRetracted, "2045-05-01T00:00:00Z");
    ASSERT_TRUE(takes(*process, "2045-12-01T00:00:00Z")) << "made later, it counts";
  }
  const auto process = start();
  process->clock().set(now_);
  EXPECT_TRUE(takes(*process, "2046-11-01T00:00:00Z")) << "less than a year after it";
}

/// A slip in the year of the first recording that is played back: nothing live would change the advice any more.
TEST_F(DatesInAcquisition, AFutureTestThatWasPlayedBackIsAnAlarmOnceTheAssetLivesUntilItIsRetracted) {
  const std::string today = format_utc(TestClock().now());
  auto process = start();
  ASSERT_TRUE(takes(*process, "2200-01-01T00:00:00Z"));
  EXPECT_THAT(told(process), IsEmpty()) << "it may be a simulated life";
  ASSERT_TRUE(takes(*process, today, false));
  const auto is_alarm = ElementsAre(AllOf(HasSubstr("A: a test of 2200-01-01T00:00:00Z was played back"),
                                          HasSubstr("sealwatch retract A --since 2030-03-1")));
  EXPECT_THAT(told(process), is_alarm);
  process.reset();
  process = start();
  EXPECT_THAT(told(process), is_alarm) << "it is known after a restart";
  retract(*process, kTestsRetracted, "2030-03-19T00:00:00Z");
  EXPECT_THAT(told(process), IsEmpty());
  process.reset();
  process = start();
  EXPECT_THAT(told(process), IsEmpty());
}

}  // namespace
}  // namespace sealwatch::testing
