// What a service says that it cannot see: strangers, a clock that follows nothing, sensors that are gone; each from when
// to when.
#include "services/common/runtime/alarms.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/timex.h>

#include <algorithm>

#include "services/common/runtime/stranger_watch.hpp"
#include "services/common/runtime/system_clock.hpp"
#include "tests/unit/runtime/harness.hpp"

namespace sealwatch::testing {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr const char* kUnknownWriter = "unknown_writer";

ServiceStatus heartbeat(const std::string& service, const std::string& writer_id) {
  ServiceStatus status;
  status.service = service;
  status.writer_id = writer_id;
  status.state = "running";
  return status;
}

template <class Content>
Message from(const std::string& writer_id, const std::string& asset_id = "A") {
  Content content;
  content.asset_id = asset_id;
  content.header.writer_id = writer_id;
  return content;
}

std::vector<std::string> names(const std::vector<StrangerWatch::Stranger>& strangers) {
  std::vector<std::string> found;
  for (const auto& one : strangers) found.push_back(one.name);
  return found;
}

/// A control system that knows no kind of alarm of sealwatch's knows these.
TEST(Ne107, StandsInTheStatusOfEachServiceAndAlarm) {
  Alarms alarms;
  ServiceStatus status;
  const auto worst = [&] { return alarms.tell(status), status.ne107; };
  const auto raise = [&](const std::string& kind) {
    alarms.raise({.kind = kind, .asset_id = {}, .subject = {}, .pst_id = {}, .text = {}, .since_ns = 0});
  };
  EXPECT_EQ(worst(), "good");
  status.state = kRestoring;
  EXPECT_EQ(worst(), "function check");
  status.state = "running";
  raise("clock_unsynchronised");
  EXPECT_EQ(worst(), "maintenance required");
  raise("flood");
  EXPECT_EQ(worst(), "out of specification");
  status.state = kRestoring;
  EXPECT_EQ(worst(), "function check");
  raise("sensor_lost");
  EXPECT_EQ(worst(), "failure");
  for (int k = 0; k < 40; ++k)
    alarms.raise(
        {.kind = "flood", .asset_id = {}, .subject = std::to_string(k), .pst_id = {}, .text = {}, .since_ns = 1});
  EXPECT_EQ(worst(), "failure") << "also where the alarm itself finds no place";
  for (const ServiceAlarm& one : status.alarms) EXPECT_EQ(one.ne107, "out of specification");
}

TEST(StrangerWatch, KnowsWhomAHeartbeatNamesBeforeOrSoonAfterTheMessage) {
  StrangerWatch watch({.services = {"data_manipulation"}});
  EXPECT_THAT(watch.hear(heartbeat("data_manipulation", "early"), seconds(0)), IsEmpty());
  EXPECT_THAT(watch.hear(from<TestFeatures>("early"), seconds(1)), IsEmpty());
  EXPECT_THAT(watch.hear(from<TestFeatures>("late"), seconds(1)), IsEmpty());
  EXPECT_THAT(watch.look(seconds(5)), IsEmpty()) << "it may overtake its writer's heartbeat";
  EXPECT_THAT(watch.hear(heartbeat("data_manipulation", "late"), seconds(6)), IsEmpty());
  EXPECT_THAT(watch.look(hours(1)), IsEmpty());
}

TEST(StrangerWatch, TellsANameThatNoHeartbeatSays) {
  StrangerWatch watch({.services = {"data_manipulation"}});
  EXPECT_THAT(watch.hear(from<TestFeatures>("forger", "XT03"), seconds(1)), IsEmpty());
  const auto strangers = watch.look(seconds(12));
  ASSERT_THAT(names(strangers), ElementsAre("forger"));
  EXPECT_THAT(strangers[0].text, HasSubstr("test_features about XT03"));
  EXPECT_THAT(watch.look(seconds(13)), IsEmpty()) << "told once";
  EXPECT_THAT(watch.hear(from<TestFeatures>("forger"), seconds(14)), IsEmpty());
  EXPECT_THAT(names(watch.look(seconds(25))), ElementsAre("forger")) << "it goes on";
}

TEST(StrangerWatch, TellsAtOnceWhoHasNoNameOrIsNoService) {
  StrangerWatch watch({.services = {"data_manipulation"}});
  EXPECT_THAT(names(watch.hear(from<TestFeatures>(""), seconds(0))), ElementsAre("no name"));
  EXPECT_THAT(names(watch.hear(heartbeat("data_corruption", "w"), seconds(0))), ElementsAre("service data_corruption"));
}

TEST(StrangerWatch, WhatPeopleSendNeedsNoHeartbeat) {
  StrangerWatch watch({.services = {"data_manipulation"}});
  for (const Message& message : {from<RawSamples>("plc"), from<RawSamples>(""), from<Acknowledgement>("operator-1"),
                                 from<MaintenanceEvent>("operator-1"), from<ModelAcceptance>("operator-1")})
    EXPECT_THAT(watch.hear(message, seconds(0)), IsEmpty());
  EXPECT_THAT(watch.look(hours(1)), IsEmpty());
}

TEST(StrangerWatch, TellsASenderThatIsNotConfiguredWhereSendersAre) {
  StrangerWatch watch({.services = {}, .senders = {"MCS-1"}});
  RawSamples block;
  block.asset_id = "XT03";
  block.source_id = "MCS-1";
  EXPECT_THAT(watch.hear(block, seconds(0)), IsEmpty());
  block.source_id = "laptop";
  EXPECT_THAT(names(watch.hear(block, seconds(0))), ElementsAre("sender laptop"));
}

TEST(StrangerWatch, AdmitsWhomAHeartbeatNamedAndConfiguredSenders) {
  StrangerWatch watch({.services = {"data_manipulation"}, .senders = {"MCS-1"}, .refuses_unknown = true});
  EXPECT_FALSE(watch.admits(from<TestFeatures>("late")));
  EXPECT_FALSE(watch.admits(from<TestFeatures>("")));
  EXPECT_TRUE(watch.admits(from<Acknowledgement>("operator-1")));
  EXPECT_THAT(watch.hear(heartbeat("data_manipulation", "late"), seconds(6)), IsEmpty());
  EXPECT_TRUE(watch.admits(from<TestFeatures>("late")));
  RawSamples block;
  EXPECT_FALSE(watch.admits(block));
  block.source_id = "MCS-1";
  EXPECT_TRUE(watch.admits(block));
  EXPECT_TRUE(StrangerWatch({.services = {"data_manipulation"}}).admits(from<TestFeatures>("any")));
}

TEST(StrangerWatch, InventedNamesKeepNoRoomFromAWriterOfThePast) {
  StrangerWatch watch({.services = {"data_manipulation"}});
  watch.expect("true");
  for (int k = 0; k < 2000; ++k)
    (void)watch.hear(heartbeat("data_manipulation", "rival-" + std::to_string(k)), seconds(1));
  EXPECT_FALSE(watch.knows("true")) << "it has not been heard yet";
  EXPECT_THAT(watch.hear(heartbeat("data_manipulation", "true"), seconds(1)), IsEmpty());
  EXPECT_TRUE(watch.knows("true"));
}

TEST(StrangerWatch, ManyNamesTakeNoMoreThanTheirRoom) {
  StrangerWatch watch({.services = {"data_manipulation"}});
  for (int k = 0; k < 100'000; ++k) {
    (void)watch.hear(from<TestFeatures>("forger-" + std::to_string(k)), seconds(1));
    (void)watch.hear(heartbeat("data_manipulation", "rival-" + std::to_string(k)), seconds(1));
  }
  EXPECT_THAT(watch.look(hours(1)), SizeIs(256));
  EXPECT_THAT(watch.hear(heartbeat("data_manipulation", "true"), hours(1)), IsEmpty());
  EXPECT_TRUE(watch.knows("true")) << "those who were silent for long make room";
}

ServiceAlarm alarm(const std::string& kind, const std::string& subject, const std::string& asset_id = "") {
  return {.kind = kind, .asset_id = asset_id, .subject = subject, .pst_id = {}, .text = {}, .since_ns = 7};
}

TEST(Alarms, StandFromTheFirstTimeUntilClearedOrOver) {
  Alarms alarms;
  EXPECT_TRUE(alarms.raise(alarm("sensor_lost", "flow", "A")));
  EXPECT_TRUE(alarms.raise(alarm("sensor_lost", "flow", "B"))) << "that of another asset";
  EXPECT_TRUE(alarms.raise(alarm("rival", "x"), seconds(10)));
  EXPECT_FALSE(alarms.raise(alarm("rival", "x"), seconds(20))) << "it stands, for longer";
  EXPECT_THAT(alarms.expire(seconds(15)), IsEmpty());
  EXPECT_THAT(alarms.expire(seconds(20)), SizeIs(1));
  EXPECT_TRUE(alarms.clear("sensor_lost", "A", "flow"));
  EXPECT_FALSE(alarms.clear("sensor_lost", "A", "flow"));
  ServiceStatus status;
  alarms.tell(status);
  EXPECT_EQ(status.alarm_count, 1U);
  EXPECT_EQ(status.alarms.at(0).asset_id, "B");
}

TEST(Alarms, StrangersDoNotFillTheMemory) {
  Alarms alarms;
  for (int k = 0; k < 10'000; ++k) alarms.raise(alarm(kUnknownWriter, std::to_string(k)), seconds(10));
  for (int k = 0; k < 300; ++k) alarms.raise(alarm("set_aside", std::to_string(k)));
  ServiceStatus status;
  alarms.tell(status);
  EXPECT_EQ(status.alarm_count, 256U + 300U);
}

/// A service, and one who looks at its heartbeats.
class TroubleTest : public ::testing::Test {
 protected:
  TroubleTest() {
    EXPECT_TRUE(listener_.subscribe_service_topics());
    options_.strangers = {.services = {"data_acquisition", "data_manipulation"}, .senders = {}};
    options_.strangers.patience = milliseconds(50);
  }
  std::unique_ptr<Process> joiner() {
    auto process = std::make_unique<Process>(
        network_, [] { return std::make_unique<JoiningLayer>(); }, place_.connection(), Fate(), options_);
    process->start();
    return process;
  }
  std::vector<ServiceAlarm> alarms(const Process& process) {
    (void)process;
    for (const BusItem& item : listener_.receive(milliseconds(5), 1000))
      if (const auto* status = std::get_if<ServiceStatus>(&item); status && !status->version.empty())
        last_ = status->alarms;
    return last_;
  }
  /// Steps until the service says so many alarms.
  ::testing::AssertionResult says(Process& process, std::size_t count) {
    const auto heard = [&] {  // also between others, where all were said before it was listened
      for (const BusItem& item : listener_.receive(milliseconds(5), 1000))
        if (const auto* status = std::get_if<ServiceStatus>(&item); status && !status->version.empty())
          if (last_ = status->alarms; last_.size() == count) return true;
      return last_.size() == count;
    };
    const bool said = step_until(heard, [&] { process.step(); });
    return said ? ::testing::AssertionSuccess() : ::testing::AssertionFailure() << last_.size() << " alarms";
  }

  Place place_;
  std::shared_ptr<InMemoryNetwork> network_ = std::make_shared<InMemoryNetwork>();
  InMemoryBus listener_{network_};
  InMemoryBus stranger_{network_};
  RunnerOptions options_ = [] {
    RunnerOptions options = fast_options();
    options.version = "under test";
    return options;
  }();
  std::vector<ServiceAlarm> last_;
};

TEST_F(TroubleTest, AnUnknownWriterIsAnAlarmUntilItIsSilentForLong) {
  options_.strangers_stand = milliseconds(1500);
  const auto process = joiner();
  TestFeatures forged;
  forged.asset_id = "A";
  forged.header = header("test_features/T", "T");
  forged.header.writer_id = "forger";
  forged.header.stream_sequence = 1;
  ASSERT_TRUE(stranger_.publish(Message(forged)));
  ASSERT_TRUE(says(*process, 1));
  EXPECT_EQ(last_[0].kind, kUnknownWriter);
  EXPECT_EQ(last_[0].subject, "forger");
  EXPECT_EQ(last_[0].since_ns, process->clock().now().nanoseconds);
  EXPECT_TRUE(says(*process, 0)) << "nothing more was heard of it";
}

/// A megabyte in a name would come back in every heartbeat of every reader, in its journal and in its log.
TEST_F(TroubleTest, AWriterWithAnEndlessNameIsNotReadAndSaidWithoutIt) {
  const auto process = joiner();
  const std::string endless(1'000'000, 'A');
  TestFeatures forged;
  forged.asset_id = "A";
  forged.header = header("test_features/T", "T");
  forged.header.writer_id = endless;
  forged.header.stream_sequence = 1;
  ASSERT_TRUE(stranger_.publish(Message(forged)));
  ServiceStatus status = heartbeat("data_manipulation", endless);
  ASSERT_TRUE(stranger_.publish(status));
  status.writer_id = "data_manipulation-1";
  status.written = {{"test_features", endless, 7}};
  ASSERT_TRUE(stranger_.publish(status));
  ASSERT_TRUE(stranger_.publish(ResendRequest{process->journal().writer_id(), "test_features", 1, 2, endless}));
  forged.header.writer_id.clear();
  forged.asset_id = endless;
  ASSERT_TRUE(stranger_.publish(Message(forged)));
  ASSERT_TRUE(says(*process, 1));
  EXPECT_EQ(last_[0].kind, kUnknownWriter);
  EXPECT_EQ(last_[0].subject, "no name");
  EXPECT_LT(last_[0].text.size(), 1000U);
  EXPECT_TRUE(process->journal().positions()->empty());
}

TEST_F(TroubleTest, AWriterThatSaysItsNameLateIsAnAlarmNoMore) {
  const auto process = joiner();
  TestFeatures early;
  early.asset_id = "A";
  early.header = header("test_features/T", "T");
  early.header.writer_id = "data_manipulation-1";
  early.header.stream_sequence = 1;
  ASSERT_TRUE(stranger_.publish(Message(early)));
  ASSERT_TRUE(says(*process, 1));
  ASSERT_TRUE(stranger_.publish(heartbeat("data_manipulation", "data_manipulation-1")));
  EXPECT_TRUE(says(*process, 0));
}

TEST_F(TroubleTest, WhatAnUnknownWriterSendsIsRefusedAndOfALateOneNothingIsLost) {
  options_.strangers.refuses_unknown = true;
  const auto process = joiner();
  const auto features = [](const std::string& writer_id, std::uint64_t sequence) {
    TestFeatures made;
    made.asset_id = "A";
    made.header = header("test_features/" + writer_id + std::to_string(sequence), writer_id + std::to_string(sequence));
    made.header.writer_id = writer_id;
    made.header.stream_sequence = sequence;
    return Message(made);
  };
  const auto open = [&] { return process->journal().open_inputs(); };
  for (const std::uint64_t sequence : {1, 2, 3})
    ASSERT_TRUE(stranger_.publish(features("data_manipulation-1", sequence)));
  ASSERT_TRUE(stranger_.publish(features("forger", 1)));
  ASSERT_TRUE(says(*process, 2));
  EXPECT_EQ(open(), 0U);
  ServiceStatus named = heartbeat("data_manipulation", "data_manipulation-1");
  named.written = {{"test_features", "data_manipulation-1", 3}};
  ASSERT_TRUE(stranger_.publish(named));
  std::vector<ResendRequest> requests;
  ASSERT_TRUE(step_until(
      [&] {
        for (const BusItem& item : listener_.receive(milliseconds(5), 1000))
          if (const auto* request = std::get_if<ResendRequest>(&item)) requests.push_back(*request);
        return !requests.empty();
      },
      [&] { process->step(); }));
  EXPECT_EQ(requests[0].writer_id, "data_manipulation-1");
  EXPECT_EQ(requests[0].first_sequence, 1U);
  for (const std::uint64_t sequence : {1, 2, 3})
    ASSERT_TRUE(stranger_.publish(features("data_manipulation-1", sequence)));
  EXPECT_TRUE(step_until([&] { return open() == 3; }, [&] { process->step(); }));
}

/// DDS matches no reader that asks for more than its writer offers, as under topics: that differ.
TEST_F(TroubleTest, WhatAServiceIsDeafToIsAnAlarmOfItsTopicUntilItComes) {
  options_.streams.given_up_s = 0.3;
  const auto process = joiner();
  ServiceStatus unheard = heartbeat("data_manipulation", "data_manipulation-1");
  unheard.written = {{"test_features", "data_manipulation-1", 1}, {"state_report", "data_manipulation-1", 0}};
  ServiceStatus stranger = heartbeat("laptop", "a stranger");
  stranger.written = {{"test_features", "a stranger", 9}, {"state_report", "a stranger", 9}};
  ASSERT_TRUE(stranger_.publish(unheard));
  ASSERT_TRUE(stranger_.publish(stranger));
  ASSERT_TRUE(says(*process, 2)) << "what a stranger invents is no more than a stranger";
  const auto missing = std::ranges::find(last_, "missing_blocks", &ServiceAlarm::kind);
  ASSERT_NE(missing, last_.end());
  EXPECT_EQ(missing->subject, "test_features");
  EXPECT_THAT(missing->text, HasSubstr("messages 1 to 1 of data_manipulation-1 do not come"));
  TestFeatures features;
  features.asset_id = "A";
  features.header = header("test_features/T", "T");
  features.header.writer_id = "data_manipulation-1";
  features.header.stream_sequence = 1;
  ASSERT_TRUE(stranger_.publish(Message(features)));
  ASSERT_TRUE(says(*process, 1));
  EXPECT_EQ(last_[0].kind, kUnknownWriter);
}

TEST_F(TroubleTest, WhatASourceSendsThatIsNoSenderIsRefusedAndItsStreamGoesOn) {
  options_.strangers = {.services = {"data_acquisition"}, .senders = {"MCS-1"}};
  Process process(
      network_, [] { return std::make_unique<CuttingLayer>(); }, place_.connection(), Fate(), options_);
  process.start();
  const auto block = [](const std::string& source_id, std::uint64_t sequence) {
    RawSamples made;
    made.asset_id = "A";
    made.source_id = source_id;
    made.recording_id = source_id + std::to_string(sequence);
    made.boundary = BlockBoundary::end;
    made.header.writer_id = sequence == 0 ? "" : "plc";
    made.header.stream_sequence = sequence;
    return Message(made);
  };
  ASSERT_TRUE(stranger_.publish(block("MCS-1", 1)));
  ASSERT_TRUE(stranger_.publish(block("laptop", 2)));
  ASSERT_TRUE(stranger_.publish(block("laptop", 0)));
  ASSERT_TRUE(stranger_.publish(block("MCS-1", 3)));
  ASSERT_TRUE(says(process, 1));
  EXPECT_EQ(last_[0].subject, "sender laptop");
  EXPECT_THAT(process.outputs(), SizeIs(4)) << "two of each test that MCS-1 sent";
  const auto positions = process.journal().positions();
  ASSERT_TRUE(positions);
  ASSERT_THAT(*positions, SizeIs(1));
  EXPECT_EQ((*positions)[0].sequence, 3U);
}

TEST_F(TroubleTest, AnUnsynchronisedClockIsAnAlarmUntilItIsSynchronised) {
  auto clock = std::make_shared<ClockReading>();
  options_.watches_clock = true;
  options_.read_clock = [clock] { return *clock; };
  const auto process = joiner();
  const std::jthread time([&, begin = std::chrono::steady_clock::now(),
                           now = process->clock().now()](const std::stop_token& over) {  // it is not set
    while (!over.stop_requested()) {
      const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
      process->clock().set(add_seconds(now, elapsed.count()));
      std::this_thread::sleep_for(milliseconds(1));
    }
  });
  process->step();
  EXPECT_THAT(alarms(*process), IsEmpty()) << "nothing is known";
  clock->quality = ClockQuality::unsynchronised;
  ASSERT_TRUE(says(*process, 1));
  EXPECT_EQ(last_[0].kind, "clock_unsynchronised");
  const std::int64_t since_ns = last_[0].since_ns;
  *clock = {};
  for (int k = 0; k < 3; ++k) process->step();
  EXPECT_THAT(alarms(*process), SizeIs(1)) << "nothing was learnt";
  EXPECT_EQ(last_[0].since_ns, since_ns);
  clock->quality = ClockQuality::synchronised;
  EXPECT_TRUE(says(*process, 0));
}

TEST(ClockReadingTest, SaysAsTheKernelDoesWhetherTheClockIsSynchronised) {
  ntptimeval time{};
  const int state = ::ntp_gettime(&time);
  if (state == -1) GTEST_SKIP() << "this sandbox lets nobody ask";
  EXPECT_EQ(read_clock().quality, state != TIME_ERROR ? ClockQuality::synchronised : ClockQuality::unsynchronised);
}

TEST_F(TroubleTest, WhatDdsSecurityRefusesIsAnAlarmForAWhile) {
  options_.strangers_stand = milliseconds(1200);
  auto refused = std::make_shared<std::optional<std::string>>();
  options_.refused_by_bus = [refused] { return std::exchange(*refused, std::nullopt); };
  const auto process = joiner();
  *refused = "somebody";
  ASSERT_TRUE(says(*process, 1));
  EXPECT_EQ(last_[0].kind, "refused_right");
  EXPECT_EQ(last_[0].text, "somebody");
  EXPECT_TRUE(says(*process, 0));
}

TEST_F(TroubleTest, ALayersAlarmsStandByItsOutputsAlsoAfterARestart) {
  // Of each test whose id begins with "bad": so no sensor is in order.
  options_.alarms_of_output = [](const Message& output) -> std::optional<StandingAlarms> {
    StandingAlarms said{.kind = "sensor_lost", .asset_id = asset_of(output), .standing = {}};
    if (header_of(output).pst_id.starts_with("bad"))
      said.standing.push_back(alarm("sensor_lost", "flow", asset_of(output)));
    return said;
  };
  const auto test = [&](const std::string& pst_id, std::uint64_t sequence) {
    TestFeatures features;
    features.asset_id = "A";
    features.header = header("test_features/" + pst_id, pst_id);
    StateReport report;
    report.asset_id = "A";
    report.header = header("state_report/" + pst_id, pst_id);
    features.header.writer_id = report.header.writer_id = "data_manipulation-1";
    features.header.stream_sequence = report.header.stream_sequence = sequence;
    ASSERT_TRUE(stranger_.publish(heartbeat("data_manipulation", "data_manipulation-1")));
    ASSERT_TRUE(stranger_.publish(Message(features)));
    ASSERT_TRUE(stranger_.publish(Message(report)));
  };
  {
    const auto process = joiner();
    test("bad-1", 1);
    ASSERT_TRUE(says(*process, 1));
    EXPECT_EQ(last_[0].asset_id, "A");
  }
  last_.clear();
  const auto process = joiner();
  ASSERT_TRUE(says(*process, 1)) << "its past says so";
  test("good-2", 2);
  EXPECT_TRUE(says(*process, 0));
}

}  // namespace
}  // namespace sealwatch::testing
