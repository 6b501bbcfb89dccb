// What people said survives the loss of a service's journal: its neighbours keep it, and it is fetched back once.
#include "sealwatch/message/act_record.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "sealwatch/message/alarm_acts.hpp"
#include "sealwatch/message/alarm_state.hpp"
#include "sealwatch/message/confirmation.hpp"
#include "sealwatch/message/retracted_tests.hpp"
#include "services/common/runtime/admission.hpp"
#include "services/common/store/journal.hpp"
#include "tests/unit/runtime/harness.hpp"

namespace sealwatch::testing {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::StartsWith;
using ::testing::UnorderedElementsAre;

/// Remembers tests and what people said of them, and says after each which tests count.
class CountingLayer final : public Layer {
 public:
  explicit CountingLayer(std::string name) : name_(std::move(name)) {}
  [[nodiscard]] std::string_view name() const override { return name_; }
  [[nodiscard]] std::span<const Topic> inputs() const override {
    static constexpr std::array kInputs = {Topic::health_report, Topic::maintenance_event, Topic::acknowledgement};
    return std::span(kInputs).first(name_ == "advisory_generation" ? 3 : 2);
  }
  [[nodiscard]] std::span<const Topic> outputs() const override { return kOutputs; }
  void restore(const Message& own) override {
    if (const auto* record = std::get_if<ActRecord>(&own))
      for (const MaintenanceEvent& event : record->events)
        if (event.tests_known) (void)retracted_.name(event.header.message_id, event.test_ids);
    const auto* advisory = std::get_if<Advisory>(&own);
    if (advisory == nullptr) return;
    const std::string about = advisory->header.message_id.substr(9);
    if (const auto retraction = retraction_of("A", about)) return retracted_.apply(*retraction);
    if (!advisory->header.pst_id.empty()) know(advisory->header);
  }
  [[nodiscard]] Conclusion receive(const Message& input) override {
    const Header& said = header_of(input);
    if (const auto* event = std::get_if<MaintenanceEvent>(&input))
      if (const auto retraction = retraction_of(*event)) retracted_.apply(*retraction);
    if (!said.pst_id.empty()) know(said);
    Advisory advisory;
    advisory.asset_id = asset_of(input);
    advisory.header = header("advisory/" + said.message_id, said.pst_id);
    advisory.header.event_time_known = !said.pst_id.empty();
    advisory.header.event_time_ns = said.pst_id.empty() ? 0 : said.event_time_ns;
    advisory.advisory_id = said.pst_id.empty() ? "" : "recommendation/" + said.pst_id;
    for (const std::string& test : tests_)
      if (retracted_.counts(test)) advisory.reasons.push_back(test);
    return {{advisory}, {said.message_id}};
  }

 private:
  void know(const Header& test) {
    tests_.insert(test.pst_id);
    retracted_.know(test.pst_id, UtcTime{test.event_time_ns});
  }
  static constexpr std::array kOutputs = {Topic::advisory};
  std::string name_;
  std::set<std::string> tests_;
  RetractedTests retracted_;
};

const std::vector<std::string> kLayers = {"state_detection", "prognostic_assessment", "advisory_generation"};

/// Three layers that listen to people and health assessment before them. Who says something goes home at once.
class ActRecordTest : public ::testing::Test {
 protected:
  struct Service {
    Place place;
    std::unique_ptr<Process> process;
  };
  ActRecordTest() {
    options_.strangers.services = kLayers;
    options_.strangers.services.emplace_back("health_assessment");
  }
  void SetUp() override {
    ASSERT_TRUE(health_.subscribe_service_topics());
    start_all();
  }
  [[nodiscard]] RunnerOptions options_of(const std::string& name) const {
    RunnerOptions options = options_;
    if (name != "advisory_generation") options.desk.reset();
    return options;
  }
  void start(const std::string& name) {
    Service& service = services_[name];
    service.process = std::make_unique<Process>(
        network_, [name] { return std::make_unique<CountingLayer>(name); }, service.place.connection(), Fate(),
        options_of(name));
    service.process->start();
  }
  void start_all() {
    for (const std::string& name : kLayers)
      if (!services_[name].process) start(name);
  }
  void stop(const std::string& name) { services_[name].process.reset(); }
  void lose(const std::string& name) {
    stop(name);
    for (const auto& entry : std::filesystem::directory_iterator(services_[name].place.directory()))
      std::filesystem::remove_all(entry.path());
  }
  /// Steps all that run, and health assessment beats and sends again what it is asked for.
  void step() {
    for (auto& [name, service] : services_)
      if (service.process) service.process->step();
    if (is_health_silent_) return;
    ServiceStatus status;
    status.service = "health_assessment";
    status.writer_id = "health_assessment-1";
    status.state = "running";
    status.written = {{"health_report", status.writer_id, tests_.size()}};
    status.alarms = told_;
    status.alarm_count = told_.size();
    EXPECT_TRUE(health_.publish(status));
    for (const BusItem& item : health_.receive(std::chrono::milliseconds(0), 1000))
      if (const auto* request = std::get_if<ResendRequest>(&item); request && request->writer_id == status.writer_id)
        send_again(*request);
  }
  void send_again(const ResendRequest& request) {
    for (std::uint64_t k = request.first_sequence; k <= std::min<std::uint64_t>(request.last_sequence, tests_.size());
         ++k)
      EXPECT_TRUE(health_.publish(tests_[k - 1]));
  }
  bool steps_until(const std::function<bool()>& done) {
    return step_until(done, [this] { step(); });
  }
  void test(const std::string& pst_id, const std::string& date) {
    HealthReport report;
    report.asset_id = "A";
    report.header = header("health_report/" + pst_id, pst_id);
    report.header.event_time_known = true;
    report.header.event_time_ns = parse_utc(date + "T00:00:00Z").value().nanoseconds;
    report.header.writer_id = "health_assessment-1";
    report.header.stream_sequence = tests_.size() + 1;
    tests_.emplace_back(report);
    EXPECT_TRUE(health_.publish(tests_.back()));
    all_take("advisory/health_report/" + pst_id);
  }
  MaintenanceEvent event(std::string_view kind, const std::string& id) {
    MaintenanceEvent event;
    event.asset_id = "A";
    event.kind = kind;
    event.reported_by = "J. Silva";
    event.remark = "wrong clock";
    event.header = header(id, "");
    event.header.event_time_known = true;
    event.header.event_time_ns = now_.nanoseconds;
    return event;
  }
  MaintenanceEvent retraction(std::string_view kind, const std::string& what) {
    now_ = add_seconds(now_, 1.0);
    return event(kind, retraction_id("A", kind, what, now_));
  }
  std::string say(const Message& act) {
    EXPECT_TRUE(InMemoryBus(network_).publish(act));
    all_take("advisory/" + header_of(act).message_id);
    return header_of(act).message_id;
  }
  void all_take(const std::string& conclusion) {
    EXPECT_TRUE(steps_until([&] {
      return std::ranges::all_of(services_, [&](auto& service) {
        return !service.second.process || std::ranges::count(conclusions(service.first), conclusion) > 0;
      });
    })) << conclusion;
  }
  std::vector<std::string> conclusions(const std::string& name) {
    std::vector<std::string> ids;
    for (const Message& output : services_[name].process->outputs()) ids.push_back(header_of(output).message_id);
    return ids;
  }
  /// The tests that count by the last conclusion about `test`.
  std::vector<std::string> counted(const std::string& name) {
    std::vector<std::string> tests;
    for (const Message& output : services_[name].process->outputs()) tests = std::get<Advisory>(output).reasons;
    return tests;
  }
  std::vector<std::string> audit(const std::string& name) {
    std::vector<std::string> lines;
    const auto acts = services_[name].process->journal().acts();
    for (const AuditEntry& entry : acts.value()) lines.push_back(entry.act.subject + " " + entry.act.outcome);
    return lines;
  }
  /// Alarms of a service's journal that was lost.
  std::vector<SetAside> alarms(const std::string& name) {
    return services_[name].process->journal().quarantine().value();
  }

  RunnerOptions options_ = fast_options();
  std::shared_ptr<InMemoryNetwork> network_ = std::make_shared<InMemoryNetwork>();
  InMemoryBus health_{network_};
  std::map<std::string, Service> services_;
  std::vector<Message> tests_;
  std::vector<ServiceAlarm> told_;  ///< alarms of health assessment
  bool is_health_silent_ = false;
  UtcTime now_ = TestClock().now();
};

TEST_F(ActRecordTest, ARetractionCountsAgainAfterTheJournalIsLost) {
  test("a", "2029-01-01");
  test("b", "2029-02-01");
  const std::string said = say(retraction(kTestRetracted, "a"));
  test("c", "2029-03-01");
  for (const std::string& name : kLayers) EXPECT_THAT(counted(name), ElementsAre("b", "c")) << name;
  lose("prognostic_assessment");
  start_all();
  all_take("advisory/health_report/c");
  all_take("advisory/" + said);
  EXPECT_THAT(conclusions("prognostic_assessment"), ElementsAre("advisory/health_report/a", "advisory/" + said,
                                                                "advisory/health_report/b", "advisory/health_report/c"))
      << "before what was tested after it";
  EXPECT_THAT(counted("prognostic_assessment"), ElementsAre("b", "c"));
  EXPECT_THAT(
      audit("prognostic_assessment"),
      ElementsAre(StartsWith(said + " waits until what it means is known here, fetched back from "), said + " taken"));
  for (int k = 0; k < 3; ++k) {  // nothing is doubled, and nothing lost, also where all is lost one after another
    const std::string& name = kLayers[static_cast<std::size_t>(k)];
    lose(name);
    start_all();
    all_take("advisory/health_report/c");
    all_take("advisory/" + said);
    for (int more = 0; more < 50; ++more) step();
    EXPECT_THAT(counted(name), ElementsAre("b", "c")) << name;
    EXPECT_THAT(audit(name), ::testing::Each(StartsWith(said))) << name;
    EXPECT_EQ(std::ranges::count(audit(name), said + " taken"), 1) << name;
    EXPECT_THAT(conclusions(name), SizeIs(4)) << name;
  }
}

/// Whatever is known when it is fetched back, it means the tests that it meant.
TEST_F(ActRecordTest, AllSinceADateMeansTheSameTestsAfterTheLoss) {
  test("a", "2029-01-01");
  test("b", "2029-02-01");
  test("c", "2029-03-01");
  const std::string said = say(retraction(kTestsRetracted, "2029-02-01T00:00:00Z"));
  test("d", "2029-04-01");
  for (const std::string& name : kLayers) EXPECT_THAT(counted(name), ElementsAre("a", "d")) << name;
  for (const std::string& name : kLayers) {
    lose(name);
    start_all();
    all_take("advisory/health_report/d");
    all_take("advisory/" + said);
    test("e" + name, "2029-05-01");
    EXPECT_THAT(counted(name), AllOf(Contains("a"), Contains("d"), Contains("e" + name))) << name;
    EXPECT_THAT(counted(name), Each(::testing::Not(::testing::AnyOf("b", "c")))) << name;
    stop(name);
    start_all();  // by its own journal
    test("f" + name, "2029-06-01");
    EXPECT_THAT(counted(name), Each(::testing::Not(::testing::AnyOf("b", "c")))) << name;
    EXPECT_THAT(counted(name), AllOf(Contains("d"), Contains("f" + name))) << name;
  }
  const std::string withdrawn = say(retraction(kRetractionWithdrawn, said));
  EXPECT_THAT(counted("state_detection"), AllOf(Contains("b"), Contains("c")));
}

TEST_F(ActRecordTest, WhatWasSaidSinceABackupIsFetchedBackOnce) {
  namespace fs = std::filesystem;
  test("a", "2029-01-01");
  test("b", "2029-02-01");
  const std::string first = say(retraction(kTestRetracted, "a"));
  stop("state_detection");
  const fs::path place = services_["state_detection"].place.directory();
  const fs::path backup = place.string() + "_backup";
  fs::copy(place, backup, fs::copy_options::recursive);
  start_all();
  const std::string second = say(retraction(kTestRetracted, "b"));
  lose("state_detection");
  for (const auto& entry : fs::directory_iterator(backup))
    fs::copy(entry.path(), place / entry.path().filename(), fs::copy_options::recursive);
  fs::remove_all(backup);
  start_all();
  all_take("advisory/" + second);
  EXPECT_THAT(audit("state_detection"),
              ElementsAre(first + " taken", StartsWith(second + " taken, fetched back from ")));
  EXPECT_THAT(counted("state_detection"), IsEmpty());
}

/// A maintenance system stays, and says its last word to whoever comes: by what is known there, it would mean others.
TEST_F(ActRecordTest, WhoSaidItAndIsStillThereChangesNothing) {
  test("a", "2029-01-01");
  test("b", "2029-02-01");
  InMemoryBus stays(network_);
  const Message said = retraction(kTestsRetracted, "2029-02-01T00:00:00Z");
  EXPECT_TRUE(stays.publish(said));
  all_take("advisory/" + header_of(said).message_id);
  test("c", "2029-03-01");
  lose("state_detection");
  start_all();
  all_take("advisory/health_report/c");
  all_take("advisory/" + header_of(said).message_id);
  EXPECT_THAT(counted("state_detection"), ElementsAre("a", "c"));
  EXPECT_THAT(audit("state_detection"), ElementsAre(HasSubstr("fetched back from"), HasSubstr("taken")));
}

/// A service that was stopped meanwhile, or has heard of one act, has not heard of all.
TEST_F(ActRecordTest, ActsComeFirstAlsoWhereTheServiceStopsBeforeItHasThemAll) {
  test("a", "2029-01-01");
  test("b", "2029-02-01");
  const Message first = retraction(kTestRetracted, "a");
  const Message second = retraction(kTestsRetracted, "2029-02-01T00:00:00Z");
  say(first);
  say(second);
  test("c", "2029-03-01");
  stop("prognostic_assessment");
  stop("advisory_generation");
  lose("state_detection");
  is_health_silent_ = true;
  const auto longest = std::exchange(options_.longest_without_acts, std::chrono::milliseconds(0));
  start("state_detection");
  for (int k = 0; k < 5; ++k) step();
  EXPECT_TRUE(InMemoryBus(network_).publish(first));
  EXPECT_TRUE(steps_until([&] { return !audit("state_detection").empty(); }));
  stop("state_detection");
  options_.longest_without_acts = longest;
  is_health_silent_ = false;
  InMemoryBus stays(network_);
  EXPECT_TRUE(stays.publish(second));
  start_all();
  all_take("advisory/health_report/c");
  all_take("advisory/" + header_of(second).message_id);
  EXPECT_THAT(counted("state_detection"), ElementsAre("c"));
}

/// Earlier versions kept no record for others: what their audit trail tells is written into one.
TEST_F(ActRecordTest, WhatAnEarlierVersionTookIsHadBackFromItsAuditTrail) {
  test("a", "2029-01-01");
  test("b", "2029-02-01");
  const std::string since = say(retraction(kTestsRetracted, "2029-02-01T00:00:00Z"));
  const std::string replaced = say(event("seal_replaced", "maintenance_event/A/seal_replaced/x/" + format_utc(now_)));
  for (const std::string& name : kLayers) stop(name);
  services_["state_detection"].place.execute("DELETE FROM outputs WHERE topic = 'act_record'");
  services_["state_detection"].place.execute(
      "UPDATE outputs SET checksum = NULL, ordinal = (SELECT count(*) FROM outputs o WHERE o.ordinal <= "
      "outputs.ordinal)");
  lose("prognostic_assessment");
  lose("advisory_generation");
  start_all();
  all_take("advisory/" + since);
  all_take("advisory/" + replaced);
  test("c", "2029-03-01");
  EXPECT_THAT(counted("prognostic_assessment"), ElementsAre("a", "c"));
}

/// An older one would part the history behind tests that were concluded from already.
TEST_F(ActRecordTest, ActsComeBackBeforeTheTests) {
  test("a", "2029-01-01");
  const std::string replaced = say(event("seal_replaced", "maintenance_event/A/seal_replaced/x/" + format_utc(now_)));
  for (int k = 0; k < 20; ++k) test("t" + std::to_string(k), "2029-03-01");
  lose("prognostic_assessment");
  start_all();
  all_take("advisory/health_report/t19");
  all_take("advisory/" + replaced);
  EXPECT_EQ(conclusions("prognostic_assessment").front(), "advisory/" + replaced);
  EXPECT_THAT(conclusions("prognostic_assessment"), SizeIs(22));
}

/// By the neighbour's answer, which comes first, the test is retracted in the dates that are known, and not in the layer.
TEST_F(ActRecordTest, ARetractionThatANeighbourHasAnsweredIsTakenAllTheSame) {
  test("a", "2029-01-01");
  test("b", "2029-02-01");
  const std::string said = say(retraction(kTestRetracted, "a"));
  HealthReport answer;
  answer.asset_id = "A";
  answer.header = header("health_report/" + said, "");
  answer.header.source_ids = {said};
  answer.header.writer_id = "health_assessment-1";
  answer.header.stream_sequence = tests_.size() + 1;
  tests_.insert(tests_.begin(), answer);
  for (std::size_t k = 0; k < tests_.size(); ++k) header_of(tests_[k]).stream_sequence = k + 1;
  lose("state_detection");
  start_all();
  all_take("advisory/" + said);
  EXPECT_THAT(counted("state_detection"), ::testing::Not(Contains("a")));
}

/// As it was: what is said after it, of the tests that count, stands.
TEST_F(ActRecordTest, ARetractionOfTheNewestTestIsTheLastWordAgain) {
  test("a", "2029-01-01");
  test("b", "2029-02-01");
  const std::string said = say(retraction(kTestRetracted, "b"));
  lose("state_detection");
  start_all();
  all_take("advisory/" + said);
  EXPECT_THAT(conclusions("state_detection"),
              ElementsAre("advisory/health_report/a", "advisory/health_report/b", "advisory/" + said));
  EXPECT_THAT(counted("state_detection"), ElementsAre("a"));
}

/// Nobody listens to it but one service: the others keep it all the same.
TEST_F(ActRecordTest, AnAcknowledgementIsKeptByThoseWhoDoNotListen) {
  test("a", "2029-01-01");
  Acknowledgement seen;
  seen.asset_id = "A";
  seen.header = header("acknowledgement/recommendation/a/1", "");
  seen.advisory_id = "recommendation/a";
  seen.acknowledged_by = "M. Okoye";
  EXPECT_TRUE(InMemoryBus(network_).publish(Message(seen)));
  const auto is_taken = [&] {
    return std::ranges::count(conclusions("advisory_generation"), "advisory/" + seen.header.message_id) == 1;
  };
  EXPECT_TRUE(steps_until(is_taken));
  for (int k = 0; k < 50; ++k) step();
  lose("advisory_generation");
  start_all();
  EXPECT_TRUE(steps_until(is_taken));
  EXPECT_THAT(conclusions("advisory_generation"),
              ElementsAre("advisory/health_report/a", "advisory/" + seen.header.message_id))
      << "once the advice is there again";
  EXPECT_THAT(audit("state_detection"), IsEmpty()) << "nobody said it there";
}

TEST_F(ActRecordTest, WhatWaitsForASecondPersonWaitsAgain) {
  options_.acts_confirmed_by_second = true;
  for (const std::string& name : kLayers) stop(name);
  start_all();
  test("a", "2029-01-01");
  const MaintenanceEvent act = retraction(kTestRetracted, "a");
  EXPECT_TRUE(InMemoryBus(network_).publish(Message(act)));
  for (int k = 0; k < 20; ++k) step();
  lose("state_detection");
  start_all();
  EXPECT_TRUE(steps_until([&] { return !audit("state_detection").empty(); }));
  EXPECT_THAT(audit("state_detection"), ElementsAre(HasSubstr("waits for a second person, fetched back from")));
  all_take("advisory/health_report/a");
  EXPECT_THAT(counted("state_detection"), ElementsAre("a"));
  MaintenanceEvent confirmed = event(kActConfirmed, confirmation_id("A", act.header.message_id, now_));
  confirmed.reported_by = "M. Okoye";
  EXPECT_TRUE(InMemoryBus(network_).publish(Message(confirmed)));
  all_take("advisory/" + act.header.message_id);
  lose("state_detection");
  start_all();
  all_take("advisory/health_report/a");
  all_take("advisory/" + act.header.message_id);
  EXPECT_THAT(counted("state_detection"), IsEmpty());
}

/// What people said is here again: the alarm says that the journal was lost, and of nothing that is to be said anew.
TEST_F(ActRecordTest, NothingIsToBeSaidAnewWhereAllIsHadBack) {
  test("a", "2029-01-01");
  const std::string said = say(retraction(kTestRetracted, "a"));
  lose("state_detection");
  start_all();
  all_take("advisory/" + said);
  step_for(std::chrono::milliseconds(1200), [this] { step(); });  // acts are looked at each second
  EXPECT_THAT(alarms("state_detection"),
              ElementsAre(::testing::Field(
                  &SetAside::reason, AllOf(HasSubstr("the journal was lost"), ::testing::Not(HasSubstr("but for"))))));
}

/// The comparison of records waits for a service that never runs. Meanwhile people speak, and services restart.
TEST_F(ActRecordTest, NoAlarmComesOfAServiceThatNeverRuns) {
  options_.strangers.services.emplace_back("data_acquisition");
  for (const std::string& name : kLayers) lose(name);
  start_all();
  const auto for_a_while = [&] { step_for(std::chrono::milliseconds(1200), [this] { step(); }); };
  for_a_while();
  ServiceStatus other;
  other.service = "health_assessment";
  other.writer_id = "health_assessment-1";
  other.written = {{kActsTopic, std::string(64, '1'), 1}};  // somebody has had a test tried again there
  EXPECT_TRUE(health_.publish(other));
  for_a_while();
  for (const std::string& name : kLayers) stop(name);
  start_all();
  EXPECT_TRUE(health_.publish(other));
  for_a_while();
  for (const std::string& name : kLayers) EXPECT_THAT(alarms(name), IsEmpty()) << name;
}

/// A flood of retractions of nothing fills what waits. One that a neighbour knows the test of is taken all the same.
TEST_F(ActRecordTest, AFloodOfInventedOnesKeepsNoRealOneOut) {
  stop("advisory_generation");
  test("a", "2029-01-01");
  stop("prognostic_assessment");
  test("before", "2029-01-15");
  test("behind", "2029-02-01");  // known to state detection alone
  is_health_silent_ = true;
  start("prognostic_assessment");
  for (std::size_t k = 0; k < kMostIdleRetractions + 1000; ++k)
    EXPECT_TRUE(InMemoryBus(network_).publish(Message(retraction(kTestRetracted, "invented" + std::to_string(k)))));
  const auto is_full = [&](const std::string& name) {
    return std::ranges::any_of(audit(name),
                               [](const std::string& line) { return line.find(" wait already") != std::string::npos; });
  };
  EXPECT_TRUE(steps_until([&] { return is_full("state_detection") && is_full("prognostic_assessment"); }));
  const Message real = retraction(kTestRetracted, "behind");
  EXPECT_TRUE(InMemoryBus(network_).publish(real));
  const std::string id = header_of(real).message_id;
  const auto waits = [&] {
    return std::ranges::any_of(audit("prognostic_assessment"), [&](const std::string& line) {
      return line.starts_with(id + " waits until what it means is known here, fetched back from state_detection");
    });
  };
  EXPECT_TRUE(steps_until(waits));
  is_health_silent_ = false;
  all_take("advisory/" + id);
  EXPECT_THAT(counted("prognostic_assessment"), ElementsAre("a", "before"));
}

/// Somebody under the name of a service sends records before the true ones, under the same ids.
class ForgedRecordTest : public ActRecordTest {
 protected:
  void forge(const std::string& id, const std::vector<MaintenanceEvent>& events) {
    ActRecord record;
    record.asset_id = "A";
    record.header = header(id, "");
    record.header.producer = "health_assessment";
    record.header.writer_id = "health_assessment-1";
    record.header.stream_sequence = ++forged_;
    record.events = events;
    EXPECT_TRUE(health_.publish(Message(record)));
  }
  std::vector<std::string> ids_of_records(const std::string& name) {
    std::vector<std::string> ids;
    EXPECT_TRUE(services_[name].process->journal().for_each_output([&](const Message& m) {
      if (topic_of(m) == Topic::act_record) ids.push_back(header_of(m).message_id);
      return Status();
    }));
    return ids;
  }
  [[nodiscard]] std::vector<ServiceAlarm> told_by(const std::string& name) {
    InMemoryBus listener(network_);
    EXPECT_TRUE(listener.subscribe_service_topics());
    std::vector<ServiceAlarm> alarms;
    EXPECT_TRUE(steps_until([&] {
      for (const BusItem& item : listener.receive(std::chrono::milliseconds(0), 1000))
        if (const auto* status = std::get_if<ServiceStatus>(&item); status && status->service == name)
          alarms = status->alarms;
      return !alarms.empty();
    }));
    return alarms;
  }
  std::uint64_t forged_ = 0;
};

TEST_F(ForgedRecordTest, UnderTheIdOfATrueOneTakesNobodysPlace) {
  test("a", "2029-01-01");
  test("b", "2029-02-01");
  const Message real = retraction(kTestRetracted, "a");
  const std::string said = say(real);
  const MaintenanceEvent other = retraction(kTestRetracted, "b");
  std::vector<std::string> taken = ids_of_records("prognostic_assessment");
  std::ranges::copy(ids_of_records("advisory_generation"), std::back_inserter(taken));
  ASSERT_THAT(taken, SizeIs(::testing::Ge(2U)));
  lose("state_detection");
  start("state_detection");
  for (const std::string& id : taken) forge(id, {});
  for (const std::string& id : taken) forge(id, {other});
  for (int k = 0; k < 5; ++k) services_["state_detection"].process->step();
  all_take("advisory/health_report/b");
  all_take("advisory/" + said);
  EXPECT_THAT(counted("state_detection"), ElementsAre("b"));
  EXPECT_THAT(told_by("state_detection"), Contains(::testing::Field(&ServiceAlarm::kind, "unknown_writer")));
}

/// They fill no journal: of each that came, the id would be kept for ever.
TEST_F(ForgedRecordTest, ThatIsNoRecordIsNotKept) {
  test("a", "2029-01-01");
  const std::string long_id = "act_record/health_assessment/" + std::string(1'000'000, 'x');
  forge(long_id, {});
  forge("act_record/health_assessment/\x1b[2J", {});
  forge("", {event("seal_replaced", "")});
  for (int k = 0; k < 300; ++k)
    forge("act_record/health_assessment/" + std::to_string(k), {retraction(kTestRetracted, std::to_string(k))});
  step_for(3 * options_.records_wait, [this] { step(); });
  Journal& journal = services_["state_detection"].process->journal();
  EXPECT_EQ(journal.has_input(long_id), false);
  for (int k = 0; k < 300; ++k)
    ASSERT_EQ(journal.has_input("act_record/health_assessment/" + std::to_string(k)), false);
  EXPECT_THAT(audit("state_detection"), IsEmpty());
  test("b", "2029-02-01");
  EXPECT_THAT(counted("state_detection"), ElementsAre("a", "b"));
}

/// What people said of alarms, to the one service that keeps their states.
class AlarmActRecordTest : public ActRecordTest {
 protected:
  AlarmActRecordTest() {
    options_.desk = AlarmDesk::Options{.service = kDesk, .services = {"health_assessment"}};
    told_ = {lost("flow"), lost("position")};
  }
  void SetUp() override {
    ActRecordTest::SetUp();
    ASSERT_TRUE(become({"sensor_lost/flow unacknowledged", "sensor_lost/position unacknowledged"}));
  }
  [[nodiscard]] ServiceAlarm lost(const std::string& channel) const {
    return {.kind = "sensor_lost",
            .asset_id = "A",
            .subject = channel,
            .pst_id = {},
            .text = "flat",
            .since_ns = now_.nanoseconds};
  }
  std::vector<std::string> states() {
    std::vector<std::string> said;
    const auto entries = services_[kDesk].process->journal().alarms();
    for (const AlarmEntry& one : entries.value())
      said.push_back((one.alarm.asset_id == "A" ? "" : one.alarm.asset_id + ": ") + alarm_id(one.alarm) + " " +
                     std::string(name_of(state_of(one, now_))));
    std::ranges::sort(said);
    return said;
  }
  bool become(const std::vector<std::string>& wanted) {
    const bool are = steps_until([&] { return states() == wanted; });
    EXPECT_THAT(states(), ElementsAreArray(wanted));
    return are;
  }
  Message seen(const std::string& alarm) {
    now_ = add_seconds(now_, 1.0);
    Acknowledgement said;
    said.asset_id = "A";
    said.advisory_id = alarm;
    said.acknowledged_by = "M. Okoye";
    said.header = header("acknowledgement/" + alarm + "/" + std::to_string(now_.nanoseconds), "");
    said.header.event_time_known = true;
    said.header.event_time_ns = now_.nanoseconds;
    return said;
  }
  Message act(std::string_view kind, const std::string& asset_id, const AlarmAct& meant = {}) {
    now_ = add_seconds(now_, 1.0);
    MaintenanceEvent said = event(kind, alarm_act_id(asset_id, now_, meant));
    said.asset_id = asset_id;
    return said;
  }
  Message shelf(const std::string& alarm) {
    return act(kAlarmShelved, "A", {.alarm_id = alarm, .until = add_seconds(now_, 86'400.0)});
  }
  /// Until the desk has taken it or refused it, and its neighbours have heard so.
  std::string tell(const Message& said) {
    const std::size_t before = audit(kDesk).size();
    EXPECT_TRUE(InMemoryBus(network_).publish(said));
    EXPECT_TRUE(steps_until([&] { return audit(kDesk).size() > before; }));
    step_for(3 * options_.records_wait, [this] { step(); });
    return header_of(said).message_id;
  }
  /// What became of an act, by the desk's audit trail.
  std::vector<std::string> outcomes(const std::string& id) {
    std::vector<std::string> said;
    for (const std::string& line : audit(kDesk))
      if (line.starts_with(id + " ")) said.push_back(line.substr(id.size() + 1));
    return said;
  }

  static constexpr const char* kDesk = "advisory_generation";
};

TEST_F(AlarmActRecordTest, WhatWasSaidOfAlarmsCountsAgainAfterTheJournalIsLost) {
  const std::string acknowledged = tell(seen("sensor_lost/flow"));
  const std::string shelved = tell(shelf("sensor_lost/position"));
  const std::string out = tell(act(kAssetOutOfService, "B"));
  const std::vector<std::string> before = states();
  EXPECT_THAT(before, ElementsAre("B: out_of_service out_of_service", "sensor_lost/flow acknowledged",
                                  "sensor_lost/position shelved"));
  for (const std::string& name : {std::string(kDesk), kLayers[0], kLayers[1], std::string(kDesk)}) {
    lose(name);
    start_all();
    ASSERT_TRUE(become(before)) << name;
    for (int more = 0; more < 50; ++more) step();
    EXPECT_EQ(states(), before) << name;
  }
  for (const std::string& id : {acknowledged, shelved, out})
    EXPECT_THAT(outcomes(id), ElementsAre(HasSubstr("fetched back from "), "taken")) << id;
  const auto kept = services_[kDesk].process->journal().alarms();
  EXPECT_EQ(std::ranges::count(kept.value(), "M. Okoye", &AlarmEntry::acknowledged_by), 1);
  for (const std::string& name : {kLayers[0], kLayers[1]})
    EXPECT_THAT(audit(name), IsEmpty()) << "nobody said it there";
}

TEST_F(AlarmActRecordTest, WhatWasTakenBackStaysSo) {
  tell(shelf("sensor_lost/flow"));
  tell(act(kAlarmUnshelved, "A", {.alarm_id = "sensor_lost/flow", .until = {}}));
  tell(act(kAssetOutOfService, "B"));
  const std::string in = tell(act(kAssetInService, "B"));
  lose(kDesk);
  start_all();
  EXPECT_TRUE(steps_until([&] { return outcomes(in).size() == 2; }));
  EXPECT_TRUE(become({"sensor_lost/flow unacknowledged", "sensor_lost/position unacknowledged"}));
}

/// What people said of another never holds for it.
TEST_F(AlarmActRecordTest, AnAlarmThatCameLaterIsUnseen) {
  const std::string flow = tell(seen("sensor_lost/flow"));
  const std::string position = tell(seen("sensor_lost/position"));
  stop(kDesk);
  now_ = add_seconds(now_, 60.0);
  told_ = {lost("flow")};
  lose(kDesk);
  start_all();
  EXPECT_TRUE(steps_until([&] { return outcomes(flow).size() == 2 && outcomes(position).size() == 2; }));
  EXPECT_TRUE(become({"sensor_lost/flow unacknowledged"}));
  EXPECT_THAT(outcomes(flow).back(), HasSubstr("it was said of an earlier alarm"));
  EXPECT_EQ(outcomes(position).back(), "its alarm is over");
}

TEST_F(AlarmActRecordTest, AnActWaitsForItsAlarmThroughARestart) {
  const std::string acknowledged = tell(seen("sensor_lost/flow"));
  const std::string shelved = tell(shelf("sensor_lost/position"));
  is_health_silent_ = true;
  lose(kDesk);
  start_all();
  EXPECT_TRUE(steps_until([&] { return outcomes(acknowledged).size() + outcomes(shelved).size() == 2; }));
  EXPECT_THAT(states(), IsEmpty());
  stop(kDesk);
  start_all();
  for (int more = 0; more < 50; ++more) step();
  is_health_silent_ = false;
  EXPECT_TRUE(become({"sensor_lost/flow acknowledged", "sensor_lost/position shelved"}));
  EXPECT_EQ(outcomes(acknowledged).size() + outcomes(shelved).size(), 4U);
}

/// A neighbour hears it too, and does not know that it counts for nothing.
TEST_F(AlarmActRecordTest, WhatTheDeskRefusedIsNotFetchedBack) {
  const std::string none = tell(shelf("sensor_lost/none"));
  EXPECT_THAT(outcomes(none), ElementsAre(HasSubstr("there is no alarm")));
  lose(kDesk);
  start_all();
  told_.push_back(lost("none"));
  EXPECT_TRUE(become(
      {"sensor_lost/flow unacknowledged", "sensor_lost/none unacknowledged", "sensor_lost/position unacknowledged"}));
  step_for(10 * options_.records_wait, [this] { step(); });
  EXPECT_THAT(outcomes(none), IsEmpty());
}

/// Since when a service is silent, only the desk knows, and it has lost its journal.
class SilenceRecordTest : public AlarmActRecordTest {
 protected:
  SilenceRecordTest() {
    options_.desk->services = {"data_acquisition"};  // on a busy machine the others fall silent, too
    options_.strangers.services.emplace_back("data_acquisition");
    options_.longest_without_acts = std::chrono::seconds(1);
    options_.desk->silence = std::chrono::milliseconds(400);  // longer than a step of all takes
    told_.clear();
  }
  void SetUp() override {
    ActRecordTest::SetUp();
    ASSERT_TRUE(become({": " + kSilent + " unacknowledged"}));
  }
  Message seen_silence() {
    Message said = seen(kSilent);
    std::get<Acknowledgement>(said).asset_id.clear();
    return said;
  }
  void lose_desk() {
    lose(kDesk);
    now_ = add_seconds(now_, 60.0);
    start_all();
    services_[kDesk].process->clock().set(now_);
  }
  void acquisition_beats() {
    ServiceStatus status;
    status.service = "data_acquisition";
    status.writer_id = "data_acquisition-1";
    EXPECT_TRUE(health_.publish(status));
  }
  const std::string kSilent = "no_heartbeat/data_acquisition";
};

TEST_F(SilenceRecordTest, ASilentServiceThatSomebodyHasSeenIsSeenAfterARestartAndTheLossOfTheJournal) {
  tell(seen_silence());
  const std::vector<std::string> before = {": " + kSilent + " acknowledged"};
  ASSERT_TRUE(become(before));
  stop(kDesk);
  start_all();
  for (int more = 0; more < 50; ++more) step();
  EXPECT_EQ(states(), before);
  lose_desk();
  EXPECT_TRUE(become(before));
}

/// That it ran meanwhile nobody else could tell.
TEST_F(SilenceRecordTest, ASilenceThatCameAfterTheOneThatSomebodySawIsUnseen) {
  const std::string said = tell(seen_silence());
  ASSERT_TRUE(become({": " + kSilent + " acknowledged"}));
  EXPECT_TRUE(steps_until([&] {
    acquisition_beats();
    return states().empty();
  }));
  ASSERT_TRUE(become({": " + kSilent + " unacknowledged"}));
  for (int more = 0; more < 100; ++more) step();
  for (int k = 0; k < 2; ++k) {
    lose_desk();
    EXPECT_TRUE(become({": " + kSilent + " unacknowledged"}));
    EXPECT_TRUE(steps_until([&] { return outcomes(said).size() == 2; }));
    for (int more = 0; more < 100; ++more) step();
    EXPECT_TRUE(become({": " + kSilent + " unacknowledged"})) << k;
  }
}

}  // namespace
}  // namespace sealwatch::testing
