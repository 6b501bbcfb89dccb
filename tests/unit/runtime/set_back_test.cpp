// A writer whose journal was replaced by a backup uses its numbers again for other messages: its reader finds out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/runtime/harness.hpp"

namespace sealwatch::testing {
namespace {

class SetBackTest : public ::testing::Test {
 protected:
  explicit SetBackTest(const std::vector<std::string>& services = {}) : services_(services) { process_.start(); }
  [[nodiscard]] RunnerOptions options() const {
    RunnerOptions options = fast_options();
    options.strangers.services = services_;
    options.longest_without_acts = std::chrono::milliseconds(500);
    return options;
  }
  /// Publishes test `pst` as number `sequence`.
  void send(std::uint64_t sequence, const std::string& pst) {
    TestFeatures features;
    features.asset_id = "A";
    features.header = header("test_features/" + pst, pst);
    features.header.writer_id = "upstream";
    features.header.stream_sequence = sequence;
    EXPECT_TRUE(writer_.publish(Message(features)));
    process_.step();
  }
  void beat(std::uint64_t written, std::int64_t started_ns) {
    ServiceStatus status;
    status.service = status.writer_id = "upstream";
    status.started_ns = started_ns;
    status.written = {{"test_features", "upstream", written}};
    EXPECT_TRUE(writer_.publish(status));
    process_.step();
  }
  /// Tests that were received, whatever their numbers.
  std::vector<std::string> received() {
    std::vector<std::string> tests;
    EXPECT_TRUE(process_.journal().for_each_open_input([&](const Message& input) {
      tests.push_back(header_of(input).pst_id);
      return Status();
    }));
    return tests;
  }

  std::vector<std::string> services_;
  Place place_;
  std::shared_ptr<InMemoryNetwork> network_ = std::make_shared<InMemoryNetwork>();
  InMemoryBus writer_{network_};
  Process process_{network_, [] { return std::make_unique<JoiningLayer>(); }, place_.connection(), Fate(), options()};
};

TEST_F(SetBackTest, ANumberThatComesWithAnotherMessageHasTheStreamReadAgain) {
  beat(0, 1);
  send(1, "p1");
  send(2, "p2");
  send(3, "p3");
  // restored to p1, then concluded p4, p3 (again) and p5, while this reader was not looking
  beat(4, 2);
  send(3, "p3");
  send(4, "p5");
  EXPECT_THAT(received(), ::testing::ElementsAre("p1", "p2", "p3", "p5"));
  send(2, "p4");  // the answer to what is asked for after a start
  send(1, "p1");
  send(2, "p4");
  send(3, "p3");
  send(4, "p5");
  EXPECT_THAT(received(), ::testing::ElementsAre("p1", "p2", "p3", "p5", "p4"));
}

TEST_F(SetBackTest, AKnownMessageUnderAnotherNumberIsEnough) {
  beat(0, 1);
  send(1, "p1");
  send(2, "p2");
  beat(2, 2);  // now p2, p4
  send(1, "p2");
  send(2, "p4");
  EXPECT_THAT(received(), ::testing::ElementsAre("p1", "p2", "p4"));
}

TEST_F(SetBackTest, WhatComesAgainAsItWasChangesNothing) {
  beat(0, 1);
  send(1, "p1");
  send(2, "p2");
  beat(2, 2);
  send(1, "p1");
  send(2, "p2");
  send(3, "p3");
  EXPECT_THAT(received(), ::testing::ElementsAre("p1", "p2", "p3"));
}

/// What a neighbour says it has read of the own stream, in the own journal or in one before it.
class OwnJournal : public SetBackTest {
 protected:
  explicit OwnJournal(const std::vector<std::string>& services = {"health_assessment", "data_manipulation"})
      : SetBackTest(services) {}
  void hear_of_own(const std::string& writer, std::uint64_t read) { hear_of({{"health_report", writer, read}}); }
  void hear_of(const std::vector<StreamPosition>& received) {
    ServiceStatus status;
    status.service = "data_manipulation";
    status.writer_id = "downstream";
    status.received = received;
    EXPECT_TRUE(writer_.publish(status));
    // An alarm is in the journal within a second or two.
    EXPECT_TRUE(step_until([&] { return !told().empty() || std::chrono::steady_clock::now() > begin_ + wait_; },
                           [&] { process_.step(); }));
  }
  std::vector<std::string> told() {
    std::vector<std::string> reasons;
    const std::vector<SetAside> found = process_.journal().quarantine().value();
    for (const SetAside& one : found) reasons.push_back(one.reason);
    return reasons;
  }
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  std::chrono::milliseconds wait_{5000};
};

TEST_F(OwnJournal, OfWhichANeighbourReadMoreThanItHasIsAnAlarm) {
  hear_of_own(process_.journal().writer_id(), 7);
  EXPECT_THAT(told(), ::testing::ElementsAre(::testing::HasSubstr("older than what data_manipulation has read of it")));
}

/// The journal is where it was all along: it is the heartbeat that is not true.
TEST_F(OwnJournal, OfWhichANeighbourSuddenlyReadMoreIsAForgedHeartbeat) {
  beat(0, 1);
  send(1, "p1");
  HealthReport report;
  report.asset_id = "A";
  report.header = header("health_report/p1", "p1");
  ASSERT_TRUE(process_.journal().begin());
  ASSERT_TRUE(process_.journal().add_output(report, UtcTime{}));
  ASSERT_TRUE(process_.journal().commit());
  wait_ = std::chrono::milliseconds(0);
  ASSERT_TRUE(writer_.subscribe_service_topics());
  hear_of_own(process_.journal().writer_id(), 1);
  begin_ = std::chrono::steady_clock::now(), wait_ = std::chrono::milliseconds(1500);
  hear_of_own(process_.journal().writer_id(), 7);
  EXPECT_THAT(told(), ::testing::IsEmpty()) << "nothing of the journal";
  std::string alarm;
  EXPECT_TRUE(step_until(
      [&] {
        for (const BusItem& item : writer_.receive(std::chrono::milliseconds(1), 1000))
          if (const auto* status = std::get_if<ServiceStatus>(&item))
            for (const ServiceAlarm& one : status->alarms) alarm = one.kind + ": " + one.text;
        return !alarm.empty();
      },
      [&] { process_.step(); }));
  EXPECT_EQ(alarm,
            "unknown_writer: it says that data_manipulation has read number 7 of health_report, of which this "
            "service has written 1: its heartbeat is forged, or its journal is damaged");
}

TEST_F(OwnJournal, BeforeWhichThereWasAnotherIsAnAlarm) {
  hear_of_own("joining-of-yesterday", 7);
  EXPECT_THAT(told(), ::testing::ElementsAre(::testing::AllOf(
                          ::testing::HasSubstr("the journal was lost, as data_manipulation knows of one before it"),
                          ::testing::HasSubstr("or somebody else sends heartbeats in its name"))));
}

/// Nobody reads the messages of the last layer: who it was is known by its heartbeat.
TEST_F(OwnJournal, BeforeWhichItsServiceHadAnotherNameIsAnAlarm) {
  hear_of({{"service_status/health_assessment", "joining-of-yesterday", 1}});
  EXPECT_THAT(told(), ::testing::ElementsAre(
                          ::testing::HasSubstr("the journal was lost, as data_manipulation knows of one before it")));
}

TEST_F(OwnJournal, OfWhichOthersKnowTheNameIsNone) {
  wait_ = std::chrono::milliseconds(1500);
  hear_of({{"service_status/health_assessment", process_.journal().writer_id(), 1},
           {"service_status/data_acquisition", "another", 1}});
  EXPECT_THAT(told(), ::testing::IsEmpty());
}

/// The loss is told also where not all neighbours run, as the one that is down may never come.
class BesideASilentService : public OwnJournal {
 protected:
  BesideASilentService() : OwnJournal({"health_assessment", "data_manipulation", "advisory_generation"}) {}
};

TEST_F(BesideASilentService, ALostJournalIsAnAlarm) {
  hear_of_own("joining-of-yesterday", 7);
  EXPECT_THAT(told(), ::testing::ElementsAre(
                          ::testing::HasSubstr("the journal was lost, as data_manipulation knows of one before it")));
}

/// A service remembers the others for them: the first name of each that had a history, also for the time after a restart.
class NamesOfOthers : public OwnJournal {
 protected:
  NamesOfOthers() { EXPECT_TRUE(writer_.subscribe_service_topics()); }
  void hear(const std::string& writer, std::uint64_t written) {
    ServiceStatus status;
    status.service = "data_manipulation";
    status.writer_id = writer;
    status.written = {{"test_features", writer, written}};
    EXPECT_TRUE(writer_.publish(status));
    process_.step();
  }
  /// In heartbeats from now on, and in the journal: a second later.
  std::set<std::string> names() {
    std::set<std::string> found;
    const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(1500);
    while (std::chrono::steady_clock::now() < until) {
      process_.step();
      for (const BusItem& item : writer_.receive(std::chrono::milliseconds(1), 1000))
        if (const auto* status = std::get_if<ServiceStatus>(&item))
          for (const StreamPosition& read : status->received)
            if (read.topic == "service_status/data_manipulation") found.insert(read.writer_id);
    }
    std::set<std::string> kept;
    const std::vector<StreamPosition> positions = process_.journal().positions().value();
    for (const StreamPosition& one : positions)
      if (one.topic.starts_with("service_status/")) kept.insert(one.writer_id);
    EXPECT_EQ(kept, found);
    return found;
  }
};

TEST_F(NamesOfOthers, AreThoseOfServicesWithAHistory) {
  hear("new", 0);
  EXPECT_THAT(names(), ::testing::IsEmpty());
  hear("of yesterday", 3);
  hear("of today", 4);
  EXPECT_THAT(names(), ::testing::ElementsAre("of yesterday"));
}

TEST(NameOfAnother, IsToldInTheFirstHeartbeatAfterARestart) {
  const Place place;
  const StreamPosition name{"service_status/data_manipulation", "of yesterday", 1};
  {
    Journal journal = std::move(*Journal::open(place.connection(), "health_assessment"));
    ASSERT_TRUE(journal.begin());
    ASSERT_TRUE(journal.set_position(name));
    ASSERT_TRUE(journal.commit());
  }
  const auto network = std::make_shared<InMemoryNetwork>();
  InMemoryBus listener(network);
  ASSERT_TRUE(listener.subscribe_service_topics());
  Process process(
      network, [] { return std::make_unique<JoiningLayer>(); }, place.connection());
  process.start();
  const std::vector<BusItem> heard = listener.receive(std::chrono::milliseconds(5000), 1);
  ASSERT_THAT(heard, ::testing::SizeIs(1));
  EXPECT_THAT(std::get<ServiceStatus>(heard[0]).received, ::testing::ElementsAre(name));
}

TEST_F(OwnJournal, OfWhichNobodyReadMoreIsNone) {
  wait_ = std::chrono::milliseconds(1500);
  hear_of_own(process_.journal().writer_id(), 0);
  EXPECT_THAT(told(), ::testing::IsEmpty());
}

}  // namespace
}  // namespace sealwatch::testing
