// The runner's side of the contracts of port/layer.hpp and message/service.hpp, one by one.
#include "services/common/runtime/layer_runner.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>

#include "sealwatch/message/replacement_id.hpp"
#include "services/common/runtime/identity.hpp"
#include "services/common/runtime/stream_window.hpp"
#include "tests/unit/runtime/harness.hpp"

namespace sealwatch::testing {
namespace {

using std::chrono::milliseconds;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Ge;
using ::testing::Gt;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Le;
using ::testing::ResultOf;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAreArray;

std::unique_ptr<Layer> cutting() { return std::make_unique<CuttingLayer>(); }
std::unique_ptr<Layer> joining() { return std::make_unique<JoiningLayer>(); }

/// What an outsider sees on the bus.
class Listener {
 public:
  explicit Listener(std::shared_ptr<InMemoryNetwork> network) : bus_(std::move(network)) {
    constexpr std::array kTopics = {Topic::test_features, Topic::state_report, Topic::health_report};
    EXPECT_TRUE(bus_.subscribe(kTopics));
    EXPECT_TRUE(bus_.subscribe_service_topics());
  }
  void listen(milliseconds timeout = milliseconds(0)) {
    for (BusItem& item : bus_.receive(timeout, 10'000)) {
      if (auto* message = std::get_if<Message>(&item)) messages.push_back(std::move(*message));
      if (auto* status = std::get_if<ServiceStatus>(&item)) statuses.push_back(std::move(*status));
      if (auto* request = std::get_if<ResendRequest>(&item)) requests.push_back(std::move(*request));
    }
  }
  std::vector<std::uint64_t> sequences(Topic topic) {
    listen();
    std::vector<std::uint64_t> found;
    for (const Message& message : messages)
      if (topic_of(message) == topic) found.push_back(header_of(message).stream_sequence);
    return found;
  }
  /// Of each asset's latest message, ascending: which asset comes last is not determined, they have lanes of their own.
  std::vector<std::uint64_t> latest_of_each_asset(Topic topic) {
    listen();
    std::map<std::string, std::uint64_t> latest;
    for (const Message& message : messages)
      if (topic_of(message) == topic) latest[asset_of(message)] = header_of(message).stream_sequence;
    std::vector<std::uint64_t> found;
    for (const auto& [asset_id, sequence] : latest) found.push_back(sequence);
    std::ranges::sort(found);
    return found;
  }
  Bus& bus() { return bus_; }
  std::vector<Message> messages;
  std::vector<ServiceStatus> statuses;
  std::vector<ResendRequest> requests;

 private:
  InMemoryBus bus_;
};

class RunnerTest : public ::testing::Test {
 protected:
  std::unique_ptr<Process> cutter(RunnerOptions options = fast_options()) {
    auto process = std::make_unique<Process>(network_, cutting, place_.connection(), Fate(), std::move(options));
    process->start();
    return process;
  }
  std::unique_ptr<Process> joiner(RunnerOptions options = fast_options()) {
    auto process = std::make_unique<Process>(network_, joining, place_.connection(), Fate(), std::move(options));
    process->start();
    return process;
  }
  static void step(Process& process, int times) {
    for (int k = 0; k < times; ++k) process.step();
  }
  void send(const Message& message) { EXPECT_TRUE(sender_.publish(message)); }
  static Message features(const std::string& pst, std::uint64_t sequence, bool replay = false,
                          const std::string& writer = "upstream") {
    TestFeatures message;
    message.asset_id = "A";
    message.header = header("test_features/" + pst, pst);
    message.header.writer_id = writer;
    message.header.stream_sequence = sequence;
    message.header.replay = replay;
    return message;
  }
  /// A block as a foreign process sends it: no id, no stream.
  static Message foreign_block(double value, BlockBoundary boundary = BlockBoundary::inside) {
    RawSamples block;
    block.asset_id = "A";
    block.recording_id = "R";
    block.boundary = boundary;
    block.samples.time_s = {value};
    return block;
  }
  static std::uint64_t inputs_open(Process& process) { return process.journal().open_inputs(); }

  Place place_;
  std::shared_ptr<InMemoryNetwork> network_ = std::make_shared<InMemoryNetwork>();
  Listener listener_{network_};
  InMemoryBus sender_{network_};
};

TEST_F(RunnerTest, PublishesWhatWasCommittedWithStamps) {
  auto process = cutter();
  Feeder feeder(network_, blocks_of_tests(2, {"A"}));
  feeder.send(4);
  step(*process, 3);
  EXPECT_THAT(listener_.sequences(Topic::test_features), ElementsAre(1, 2));
  for (const Message& message : listener_.messages) {
    EXPECT_EQ(header_of(message).writer_id, process->journal().writer_id());
    EXPECT_EQ(header_of(message).publishing_time_ns, process->clock().now().nanoseconds);
  }
  EXPECT_THAT(process->outputs(), SizeIs(4));
}

TEST_F(RunnerTest, PublishesTheLastStateOfEveryAssetAgainAtTheStart) {
  {
    auto process = cutter();
    Feeder feeder(network_, blocks_of_tests(3, {"A", "B"}));
    feeder.send(100);
    step(*process, 3);
  }
  const auto features = listener_.latest_of_each_asset(Topic::test_features);
  const auto reports = listener_.latest_of_each_asset(Topic::state_report);
  EXPECT_THAT(features, ElementsAre(Gt(0U), 6));
  Listener late(network_);
  EXPECT_THAT(late.sequences(Topic::test_features), IsEmpty()) << "its history went with the writer";
  auto process = cutter();
  EXPECT_THAT(late.sequences(Topic::test_features), UnorderedElementsAreArray(features));
  EXPECT_THAT(late.sequences(Topic::state_report), UnorderedElementsAreArray(reports));
}

TEST_F(RunnerTest, SendsAgainWhatIsAskedForAndEndsWithTheLatest) {
  auto process = cutter();
  Feeder feeder(network_, blocks_of_tests(5, {"A"}));
  feeder.send(100);
  step(*process, 3);
  listener_.listen();
  listener_.messages.clear();
  const std::string writer = process->journal().writer_id();
  EXPECT_TRUE(listener_.bus().publish(ResendRequest{writer, "test_features", 0, 2, "listener"}));
  EXPECT_TRUE(listener_.bus().publish(ResendRequest{"somebody else", "test_features", 1, 4, "listener"}));
  EXPECT_TRUE(listener_.bus().publish(ResendRequest{writer, "advisory", 1, 4, "listener"}));
  EXPECT_TRUE(listener_.bus().publish(ResendRequest{writer, "no_topic", 1, 4, "listener"}));
  const auto have_come = [&](std::size_t count) {  // it rests after each, as long as that took
    return step_until([&] { return listener_.sequences(Topic::test_features).size() >= count; },
                      [&] { step(*process, 1); });
  };
  EXPECT_TRUE(have_come(3));
  step(*process, 3);
  EXPECT_THAT(listener_.sequences(Topic::test_features), ElementsAre(1, 2, 5))
      << "a late subscriber must find the latest as the last one published";
  EXPECT_THAT(listener_.sequences(Topic::state_report), IsEmpty());
  EXPECT_TRUE(listener_.bus().publish(ResendRequest{writer, "test_features", 5, 900, "listener"}));
  EXPECT_TRUE(have_come(4));
  step(*process, 3);
  EXPECT_THAT(listener_.sequences(Topic::test_features), ElementsAre(1, 2, 5, 5)) << "no more than there is";
}

TEST_F(RunnerTest, ServesALongRequestInTurnsWhileItGoesOnReceiving) {
  auto process = cutter();
  Feeder feeder(network_, blocks_of_tests(100, {"A"}));
  feeder.send(200);
  // The latest ends each turn: how many turns there are, and so how many messages, the machine's speed decides.
  const auto all_came = [&] {
    const auto sequences = listener_.sequences(Topic::test_features);
    return std::set<std::uint64_t>(sequences.begin(), sequences.end()).size() == 100;
  };
  ASSERT_TRUE(step_until(all_came, [&] { step(*process, 1); }));
  listener_.messages.clear();
  EXPECT_TRUE(listener_.bus().publish(ResendRequest{process->journal().writer_id(), "test_features", 1, 100, "l"}));
  step(*process, 1);
  EXPECT_THAT(listener_.sequences(Topic::test_features), SizeIs(Ge(16)));
  EXPECT_TRUE(step_until(all_came, [&] { step(*process, 1); })) << "it rests, and goes on";
  auto sequences = listener_.sequences(Topic::test_features);
  std::erase(sequences, 100U);
  EXPECT_THAT(sequences, SizeIs(99)) << "and none but the latest twice";
}

/// Of which each message takes its time, as where a reader is slow.
class SlowBus final : public Bus {
 public:
  explicit SlowBus(std::shared_ptr<InMemoryNetwork> network) : bus_(std::move(network)) {}
  Status subscribe(std::span<const Topic> topics) override { return bus_.subscribe(topics); }
  Status subscribe_service_topics() override { return bus_.subscribe_service_topics(); }
  Status publish(const Message& message) override {
    std::this_thread::sleep_for(milliseconds(1));
    return bus_.publish(message);
  }
  Status publish(const ServiceStatus& status) override { return bus_.publish(status); }
  Status publish(const ResendRequest& request) override { return bus_.publish(request); }
  std::vector<BusItem> receive(milliseconds timeout, std::size_t most) override { return bus_.receive(timeout, most); }
  void wake() override { bus_.wake(); }

 private:
  InMemoryBus bus_;
};

/// Who joins meanwhile, a command of an operator, would judge by what was so a hundred tests ago.
TEST_F(RunnerTest, TheLatestIsTheLastWordAlsoWhileALongRequestIsServed) {
  SlowBus bus(network_);
  InMemoryBus heartbeat_bus(network_);
  TestClock clock;
  auto journal = Journal::open(place_.connection(), "data_manipulation");
  LayerRunner runner([](const std::string&) { return cutting(); }, bus, heartbeat_bus, *journal, clock, fast_options());
  ASSERT_TRUE(runner.start());
  const auto step = [&] { ASSERT_TRUE(runner.step(milliseconds(1))); };
  Feeder feeder(network_, blocks_of_tests(100, {"A"}));
  feeder.send(200);
  const auto all_came = [&] { return listener_.sequences(Topic::test_features).size() >= 100; };
  ASSERT_TRUE(step_until(all_came, step));
  listener_.messages.clear();
  EXPECT_TRUE(listener_.bus().publish(ResendRequest{journal->writer_id(), "test_features", 1, 99, "l"}));
  EXPECT_TRUE(step_until([&] { return listener_.sequences(Topic::test_features).size() >= 99; },
                         [&] {
                           step();
                           EXPECT_THAT(Listener(network_).sequences(Topic::test_features), ElementsAre(100));
                         }));
}

TEST_F(RunnerTest, AGapIsFilledBeforeAnythingBeyondItIsConcluded) {
  auto process = joiner();
  send(features("p3", 3));
  step(*process, 2);
  EXPECT_EQ(inputs_open(*process), 0U) << "held back";
  ASSERT_TRUE(step_until([&] { return listener_.listen(), !listener_.requests.empty(); }, [&] { process->step(); }));
  EXPECT_EQ(listener_.requests[0].first_sequence, 1U);
  EXPECT_EQ(listener_.requests[0].last_sequence, 2U);
  EXPECT_EQ(listener_.requests[0].writer_id, "upstream");
  EXPECT_EQ(listener_.requests[0].topic, "test_features");
  send(features("p1", 1));
  send(features("p2", 2));
  step(*process, 2);
  std::vector<std::string> order;
  EXPECT_TRUE(process->journal().for_each_open_input(
      [&](const Message& m) { return order.push_back(header_of(m).pst_id), Status(); }));
  EXPECT_THAT(order, ElementsAre("p1", "p2", "p3"));
}

TEST_F(RunnerTest, AMessageThatComesFromTwoWritersIsTakenOnce) {
  auto process = joiner();
  send(features("p1", 1, false, "writer before its journal was lost"));
  send(features("p1", 1, false, "writer after"));
  send(features("p2", 2, false, "writer after"));
  step(*process, 2);
  EXPECT_EQ(inputs_open(*process), 2U);
  const auto positions = process->journal().positions().value();
  EXPECT_THAT(positions, ::testing::Contains(StreamPosition{"test_features", "writer after", 2}));
}

/// A sender that names blocks by recording and number alone gives those of two assets the same ids.
TEST_F(RunnerTest, AnIdThatIsAnotherAssetsHidesNothing) {
  auto process = cutter();
  const auto named = [](const std::string& asset) {
    Message block = foreign_block(1.0);
    std::get<RawSamples>(block).asset_id = asset;
    header_of(block).message_id = "april/0";
    return block;
  };
  send(named("A"));
  step(*process, 2);
  send(named("B"));
  send(named("A"));
  send(named("B"));
  step(*process, 2);
  EXPECT_EQ(process->journal().asset_of_input("april/0").value(), "A");
  EXPECT_EQ(process->journal().asset_of_input("april/0@B").value(), "B");
  EXPECT_EQ(process->journal().asset_of_input("april/0@A").value(), std::nullopt);
}

/// Tests of two assets whose ids differ only in what ids of tests have not have one id, and so have their conclusions.
TEST_F(RunnerTest, AConclusionWhoseIdIsAnotherAssetsIsKeptBesideItAndTakenOnce) {
  const auto ids_and_assets = [](Process& process) {
    std::vector<std::pair<std::string, std::string>> found;
    for (const Message& output : process.outputs()) found.emplace_back(header_of(output).message_id, asset_of(output));
    return found;
  };
  const auto expected = ::testing::ElementsAre(
      std::pair("test_features/april", "XT_1"), std::pair("state_report/april", "XT_1"),
      std::pair("test_features/april@XT 1", "XT 1"), std::pair("state_report/april@XT 1", "XT 1"));
  for (const std::string again : {"", " again"}) {
    auto process = cutter();
    for (const std::string asset_id : {"XT_1", "XT 1"}) {
      for (RawSamples block : blocks_of_tests(1, {asset_id})) {
        block.recording_id = "april";
        block.header.message_id += again;
        send(Message(block));
      }
      step(*process, 2);
    }
    EXPECT_THAT(ids_and_assets(*process), expected);
  }
}

TEST_F(RunnerTest, AForeignSendersMessagesGetIdsAndTheLastOneMayComeAgain) {
  {
    auto process = cutter();
    send(foreign_block(1.0));
    send(foreign_block(2.0));
    send(foreign_block(2.0));
    step(*process, 2);
    EXPECT_EQ(inputs_open(*process), 2U) << "the second of two equal messages is a repetition";
  }
  auto process = cutter();  // the network gives it the sender's last message again
  step(*process, 2);
  EXPECT_EQ(inputs_open(*process), 2U);
  send(foreign_block(1.0));
  step(*process, 2);
  EXPECT_EQ(inputs_open(*process), 3U) << "the same content later, after something else, is news";
  std::vector<std::string> ids;
  EXPECT_TRUE(process->journal().for_each_open_input(
      [&](const Message& m) { return ids.push_back(header_of(m).message_id), Status(); }));
  EXPECT_THAT(ids[0], ::testing::MatchesRegex("raw_samples/A/[0-9a-f]{16}"));
  EXPECT_EQ(ids[2], ids[0] + "#2");
}

class TimeTest : public RunnerTest {
 protected:
  /// How often time passes in the second after `messages` came.
  template <class BusOfService = InMemoryBus>
  std::size_t ticks_after(const std::vector<Message>& messages, RunnerOptions options = fast_options(),
                          milliseconds second = milliseconds(1050)) {
    options.heartbeat.interval = milliseconds(1000);  // or the bus is never found empty after a second's sleep
    std::vector<UtcTime> ticks;
    const auto layer = [&ticks](const std::string&) {
      auto made = std::make_unique<JoiningLayer>();
      made->ticks = &ticks;
      return made;
    };
    BusOfService bus(network_);
    InMemoryBus heartbeat_bus(network_);
    TestClock clock;
    auto journal = Journal::open(place_.connection(), "health_assessment");
    LayerRunner runner(layer, bus, heartbeat_bus, *journal, clock, options);
    EXPECT_TRUE(runner.start());
    for (const Message& message : messages) send(message);
    EXPECT_TRUE(runner.step(milliseconds(1)));
    std::this_thread::sleep_for(second);
    EXPECT_TRUE(runner.step(milliseconds(1)));
    EXPECT_THAT(ticks, ::testing::Each(clock.now()));
    return ticks.size();
  }
};

TEST_F(TimeTest, PassesOnceASecondInLiveOperation) { EXPECT_EQ(ticks_after({features("p1", 1)}), 2U); }

/// A test would be overdue that nobody can make undone when the clock is right again.
TEST_F(TimeTest, GoesOnAsItDidWhileTheClockMayBeWrong) {
  std::vector<UtcTime> ticks;
  const auto layer = [&ticks] {
    auto made = std::make_unique<JoiningLayer>();
    made->ticks = &ticks;
    return made;
  };
  RunnerOptions options = fast_options();
  options.assets = {"A"};
  options.read_clock = [] { return ClockReading{}; };
  Process process(network_, layer, place_.connection(), Fate(), options);
  process.start();
  const UtcTime begin = process.clock().now();
  const auto steady_begin = std::chrono::steady_clock::now();
  for (const double set_by_s : {0.0, 3.0e6, 0.0, -7200.0}) {
    const std::size_t before = ticks.size();
    ASSERT_TRUE(step_until([&] { return ticks.size() > before + 1; },
                           [&] {
                             const std::chrono::duration<double> elapsed =
                                 std::chrono::steady_clock::now() - steady_begin;
                             process.clock().set(add_seconds(begin, elapsed.count() + set_by_s));
                             process.step();
                           }));
  }
  for (const UtcTime& tick : ticks) EXPECT_LT(std::abs(seconds_between(begin, tick)), 60.0);
}

TEST_F(TimeTest, StandsStillInAReplay) { EXPECT_EQ(ticks_after({features("p1", 1, true)}), 0U); }

TEST_F(TimeTest, PassesInAReplayOfAnAssetWhoseTestsAreDue) {
  RunnerOptions options = fast_options();
  options.commissioned["A"] = UtcTime{0};
  EXPECT_EQ(ticks_after({features("p1", 1, true)}, options), 2U);
}

TEST_F(TimeTest, PassesForALiveAssetOfWhichAHistoryIsPlayedBack) {
  Message live = features("p1", 1);
  header_of(live).event_time_known = true;
  EXPECT_EQ(ticks_after({live, features("p0", 2, true)}), 2U);
}

TEST_F(TimeTest, StandsStillWhileMessagesAreMissing) { EXPECT_EQ(ticks_after({features("p3", 3)}), 0U); }

TEST_F(TimeTest, StandsStillUntilTheWritersHaveBeenHeard) {
  RunnerOptions options = fast_options();
  options.settling = milliseconds(2000);  // longer than a busy machine takes for the first step
  EXPECT_EQ(ticks_after({features("p1", 1)}, options, milliseconds(2050)), 1U);
}

/// Gives little at a time and has more, as one does of which one asset's flood wants more than its share.
class SharingBus final : public Bus {
 public:
  explicit SharingBus(std::shared_ptr<InMemoryNetwork> network) : bus_(std::move(network)) {}
  Status subscribe(std::span<const Topic> topics) override { return bus_.subscribe(topics); }
  Status subscribe_service_topics() override { return bus_.subscribe_service_topics(); }
  Status publish(const Message& message) override { return bus_.publish(message); }
  Status publish(const ServiceStatus& status) override { return bus_.publish(status); }
  Status publish(const ResendRequest& request) override { return bus_.publish(request); }
  std::vector<BusItem> receive(milliseconds timeout, std::size_t most) override {
    return bus_.receive(timeout, std::min<std::size_t>(most, 3));
  }
  bool has_more() override { return true; }
  void wake() override { bus_.wake(); }

 private:
  InMemoryBus bus_;
};

TEST_F(TimeTest, StandsStillWhileTheBusHasMoreThanItGives) {
  EXPECT_EQ(ticks_after<SharingBus>({features("p1", 1)}), 0U);
}

/// Something that a stranger sends before every step of a service.
class TimeUnderFloodTest : public RunnerTest {
 protected:
  bool passes(RunnerOptions options, const std::function<void()>& flood) {
    std::vector<UtcTime> ticks;
    const auto layer = [&ticks](const std::string&) {
      auto made = std::make_unique<JoiningLayer>();
      made->ticks = &ticks;
      return made;
    };
    options.assets = {"A"};
    InMemoryBus bus(network_);
    InMemoryBus heartbeat_bus(network_);
    TestClock clock;
    auto journal = Journal::open(place_.connection(), "health_assessment");
    LayerRunner runner(layer, bus, heartbeat_bus, *journal, clock, options);
    EXPECT_TRUE(runner.start());
    // The first second is that of the start.
    return step_until([&] { return ticks.size() > 1; },
                      [&] {
                        flood();
                        EXPECT_TRUE(runner.step(milliseconds(1)));
                      },
                      std::chrono::seconds(20));
  }
};

TEST_F(TimeUnderFloodTest, PassesThoughTheBusIsNeverEmptied) {
  RunnerOptions options = fast_options();
  options.longest_wait = milliseconds(500);
  EXPECT_TRUE(passes(options, [this] {
    for (int k = 0; k < 100; ++k) ASSERT_TRUE(listener_.bus().publish(ServiceStatus()));
  }));
}

TEST_F(TimeUnderFloodTest, PassesThoughEverNewStrangersSayThatThereIsMoreOfThem) {
  RunnerOptions options = fast_options();
  options.streams.given_up_s = 0.5;
  int strangers = 0;
  EXPECT_TRUE(passes(options, [&] {
    ServiceStatus forged;
    forged.service = "state_detection";
    forged.writer_id = "stranger " + std::to_string(++strangers);
    forged.written = {{"test_features", forged.writer_id, 7}};
    ASSERT_TRUE(listener_.bus().publish(forged));
  }));
}

TEST_F(TimeUnderFloodTest, PassesThoughAStreamGoesOnForEver) {
  RunnerOptions options = fast_options();
  options.longest_behind = milliseconds(500);
  std::uint64_t sent = 0;
  EXPECT_TRUE(passes(options, [&] {
    TestFeatures forged;
    forged.asset_id = "A";
    const std::string pst_id = "forged-" + std::to_string(++sent);
    forged.header = header("test_features/" + pst_id, pst_id);
    forged.header.writer_id = "crawler";
    forged.header.stream_sequence = sent;
    ASSERT_TRUE(listener_.bus().publish(Message(forged)));
    ServiceStatus claim;
    claim.service = "data_manipulation";
    claim.writer_id = "crawler";
    claim.written = {{"test_features", "crawler", 1'000'000'000}};
    ASSERT_TRUE(listener_.bus().publish(claim));
  }));
}

TEST_F(RunnerTest, AsksForWhatIsMissingUnderAFloodToo) {
  const auto process = joiner();
  TestFeatures features;
  features.asset_id = "A";
  features.header = header("test_features/3", "3");
  features.header.writer_id = "w";
  features.header.stream_sequence = 3;
  ASSERT_TRUE(listener_.bus().publish(Message(features)));
  const auto asked = [&] {
    listener_.listen();
    return !listener_.requests.empty();
  };
  EXPECT_TRUE(step_until(asked, [&] {
    for (int k = 0; k < 100; ++k) ASSERT_TRUE(listener_.bus().publish(ServiceStatus()));
    process->step();
  }));
}

TEST_F(RunnerTest, SaysInEveryMessageHowItsClockIsKeptAndWhenItStartedAndJournalsNeither) {
  auto clock = std::make_shared<ClockReading>(ClockReading{ClockQuality::synchronised, true, 0.002});
  RunnerOptions options = fast_options();
  options.read_clock = [clock] { return *clock; };
  const auto process = cutter(options);
  Feeder feeder(network_, blocks_of_tests(2, {"A"}));
  const auto conclusions = [&](std::size_t count) {
    feeder.send(2);
    return step_until([&] { return listener_.sequences(Topic::test_features).size() == count; },
                      [&] { process->step(); });
  };
  ASSERT_TRUE(conclusions(1));
  const Header first = header_of(listener_.messages.back());
  EXPECT_EQ(first.clock_quality, ClockQuality::synchronised);
  EXPECT_TRUE(first.clock_error_known);
  EXPECT_EQ(first.clock_error_s, 0.002);
  EXPECT_EQ(first.writer_started_ns, process->clock().now().nanoseconds);
  *clock = {};
  process->clock().set(add_seconds(process->clock().now(), 3600.0));
  step_for(milliseconds(1100), [&] { process->step(); });
  ASSERT_TRUE(conclusions(2));
  const Header second = header_of(listener_.messages.back());
  EXPECT_EQ(second.clock_quality, ClockQuality::stepped);
  EXPECT_FALSE(second.clock_error_known);
  EXPECT_EQ(second.writer_started_ns, first.writer_started_ns);
  for (const Message& kept : process->outputs()) EXPECT_EQ(kept, without_stamps(kept));
}

TEST(Identity, OfAMessageThatGivesNoneIsThatOfBeforeHeadersSaidHowClocksAreKept) {
  Acknowledgement message;
  message.asset_id = "A";
  message.header.schema_version = 1;
  message.header.clock_quality = ClockQuality::stepped;
  message.header.clock_error_known = true;
  message.header.clock_error_s = 0.5;
  message.header.writer_started_ns = 4711;
  const std::string before =
      R"({"asset_id":"A","header":{"schema_version":1,"message_id":"","pst_id":"","source_ids":[],"producer":"",)"
      R"("event_time_known":false,"event_time_ns":0,"publishing_time_ns":0,"replay":false,"writer_id":"",)"
      R"("stream_sequence":0},"advisory_id":"","acknowledged_by":"","remark":""})";
  const EarlierInputs none = {.has = [](const std::string&) { return false; },
                              .last_unnumbered = [](Topic, const std::string&) { return std::string(); }};
  EXPECT_EQ(identify(Message(message), none), "acknowledgement/A/" + content_hash(before));
}

/// Blocks that are ready, one a piece.
class FakeLocalInputs final : public LocalInputs {
 public:
  explicit FakeLocalInputs(std::vector<RawSamples> blocks) : blocks_(blocks.begin(), blocks.end()) {}
  void look(const LayerAtRest&, const LayerAtRest&) override { ++looks; }
  bool has_some() override { return !blocks_.empty(); }
  std::vector<Message> take() override {
    std::vector<Message> piece = {blocks_.front()};
    blocks_.pop_front();
    return piece;
  }
  bool stop(std::chrono::milliseconds) override { return true; }
  int looks = 0;

 private:
  std::deque<RawSamples> blocks_;
};

TEST_F(RunnerTest, TakesLocalInputsOnceAndLooksForThemEverySecond) {
  std::vector<RawSamples> twice = blocks_of_tests(1, {"A"});
  twice.insert(twice.end(), twice.begin(), twice.end());
  const auto local = std::make_shared<FakeLocalInputs>(twice);
  RunnerOptions options = fast_options();
  options.local_inputs = local;
  const auto begin = std::chrono::steady_clock::now();
  auto process = cutter(options);
  step(*process, 20);
  std::this_thread::sleep_for(milliseconds(1050));
  step(*process, 3);
  const auto seconds = std::chrono::floor<std::chrono::seconds>(std::chrono::steady_clock::now() - begin);
  EXPECT_THAT(local->looks, AllOf(Ge(2), Le(1 + seconds.count())));
  EXPECT_FALSE(local->has_some());
  EXPECT_THAT(process->outputs(), SizeIs(2));
}

/// Says that there is something, from a thread of its own, after a while.
class LateLocalInputs final : public LocalInputs {
 public:
  void look(const LayerAtRest&, const LayerAtRest&) override {}
  void on_some(std::function<void()> call) override { call_ = std::move(call); }
  bool has_some() override { return has_some_; }
  std::vector<Message> take() override {
    has_some_ = false;
    is_taken = true;
    return {};
  }
  bool stop(milliseconds) override { return true; }
  void come() {
    has_some_ = true;
    if (call_) call_();
  }
  bool is_taken = false;

 private:
  std::function<void()> call_;
  std::atomic<bool> has_some_ = false;
};

TEST_F(RunnerTest, LocalInputsWakeItWhenTheyCome) {
  const auto local = std::make_shared<LateLocalInputs>();
  RunnerOptions options = fast_options();
  options.local_inputs = local;
  options.heartbeat.interval = std::chrono::seconds(60);  // it hears its own
  auto process = cutter(options);
  const auto quiet = std::chrono::steady_clock::now() + milliseconds(1000);
  while (std::chrono::steady_clock::now() < quiet) step(*process, 1);  // all is looked back at
  const std::jthread later([&] {
    std::this_thread::sleep_for(milliseconds(100));
    local->come();
  });
  const auto begin = std::chrono::steady_clock::now();
  while (!local->is_taken) ASSERT_TRUE(process->try_step(std::chrono::seconds(60)));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
}

/// Forty recordings of the largest size held up a live test for half a minute.
TEST_F(RunnerTest, WhatIsLiveGoesAmongLocalInputs) {
  const auto local = std::make_shared<FakeLocalInputs>(blocks_of_tests(500, {"A"}));
  RunnerOptions options = fast_options();
  options.local_inputs = local;
  auto process = cutter(options);
  step(*process, 3);
  for (const RawSamples& block : blocks_of_tests(1, {"B"})) send(block);
  step(*process, 10);
  EXPECT_TRUE(local->has_some());
  EXPECT_THAT(process->outputs(), Contains(ResultOf([](const Message& m) { return asset_of(m); }, "B")));
}

/// It went on, and what it had confirmed was gone at its next start.
TEST_F(RunnerTest, AJournalThatWasRemovedEndsTheServiceAlsoWhereNothingComes) {
  for (const char* end : {"", "-wal"}) {
    auto process = cutter();
    for (const RawSamples& block : blocks_of_tests(1, {"A"})) send(block);
    step(*process, 3);
    std::filesystem::remove((place_.directory() / "journal.db").string() + end);
    std::this_thread::sleep_for(milliseconds(1050));
    const Status stepped = process->try_step();
    ASSERT_FALSE(stepped) << end;
    EXPECT_THAT(stepped.error().describe(), AllOf(HasSubstr((place_.directory() / "journal.db").string() + end),
                                                  HasSubstr("was removed or replaced while this service ran")));
  }
}

/// A sender that outruns the flow watches positions; what is dropped into a directory does, too.
TEST_F(RunnerTest, LocalInputsWaitForAReaderThatIsFarBehind) {
  const auto local = std::make_shared<FakeLocalInputs>(blocks_of_tests(500, {"A"}));
  RunnerOptions options = fast_options();
  options.local_inputs = local;
  auto process = cutter(options);
  const auto beat = [&](std::uint64_t position) {
    ServiceStatus status;
    status.service = status.writer_id = "reader";
    status.received = {{"test_features", process->journal().writer_id(), position}};
    EXPECT_TRUE(sender_.publish(status));
  };
  constexpr std::uint64_t kWindow = stream_window("test_features");
  beat(0);
  step(*process, 800);
  const auto written = [&] { return process->journal().written().at(Topic::test_features); };
  const std::uint64_t at_first = written();
  EXPECT_GT(at_first, kWindow);
  EXPECT_LT(at_first, kWindow + 20);
  beat(at_first);
  step(*process, 800);
  EXPECT_GT(written(), at_first + 100);
}

/// Computes until `computed` returns, before anything of it can have been committed.
class SlowLayer final : public JoiningLayer {
 public:
  explicit SlowLayer(std::function<void()> computed) : computed_(std::move(computed)) {}
  Conclusion receive(const Message& input) override {
    computed_();
    return JoiningLayer::receive(input);
  }

 private:
  std::function<void()> computed_;
};

TEST_F(RunnerTest, BeatsWhileTheLayerComputesAndSaysThatAnInputWaits) {
  std::vector<ServiceStatus> while_computing;
  std::atomic<bool> computed_once = false;
  const auto says_all = [&] {  // as often as in 200 ms on a machine that does nothing else
    return listener_.statuses.size() > 10 && !listener_.statuses.back().received.empty();
  };
  const auto computed = [&] {
    (void)step_until(says_all, [&] { listener_.listen(milliseconds(5)); });
    while_computing = std::move(listener_.statuses);
    listener_.statuses.clear();
    computed_once = true;
  };
  RunnerOptions options = fast_options();
  options.batch_time = milliseconds(20);
  Process process(
      network_, [&] { return std::make_unique<SlowLayer>(computed); }, place_.connection(), Fate(), options);
  process.start();
  send(features("p1", 1));
  std::this_thread::sleep_for(milliseconds(30));
  listener_.listen();
  listener_.statuses.clear();
  ASSERT_TRUE(step_until([&] { return computed_once.load(); }, [&] { process.step(); }));
  ASSERT_THAT(while_computing, SizeIs(Gt(10U)));
  EXPECT_EQ(while_computing.back().pending_inputs, 1U);
  EXPECT_THAT(while_computing.back().received, ElementsAre(StreamPosition{"test_features", "upstream", 1}))
      << "it is in the journal";
  EXPECT_EQ(process.journal().open_inputs(), 1U);
}

/// Counts the replacements that reach it.
class EventLayer final : public Layer {
 public:
  [[nodiscard]] std::string_view name() const override { return "state_detection"; }
  [[nodiscard]] std::span<const Topic> inputs() const override { return kInputs; }
  [[nodiscard]] std::span<const Topic> outputs() const override { return kOutputs; }
  void restore(const Message& /*own*/) override {}
  [[nodiscard]] Conclusion receive(const Message& input) override {
    Conclusion conclusion{{}, {header_of(input).message_id}};
    if (!std::holds_alternative<MaintenanceEvent>(input)) return conclusion;
    StateReport report;
    report.asset_id = asset_of(input);
    report.header = header("state_report/" + header_of(input).message_id, "");
    conclusion.outputs = {report};
    return conclusion;
  }

 private:
  static constexpr std::array kInputs = {Topic::maintenance_event, Topic::test_features};
  static constexpr std::array kOutputs = {Topic::state_report};
};

TEST_F(RunnerTest, AMessageThatCannotBeReadIsToldOfAndItsStreamGoesOn) {
  auto process = std::make_unique<Process>(
      network_, [] { return std::make_unique<CuttingLayer>(); }, place_.connection());
  process->start();
  auto blocks = blocks_of_tests(2, {"A"});
  const std::string lost = blocks[1].header.message_id;
  blocks[1] = {};  // as the bus makes it (topic_types.cpp)
  blocks[1].asset_id = "A";
  blocks[1].header.message_id = "unreadable/" + lost;
  Feeder feeder(network_, blocks);
  feeder.send(4);
  ASSERT_TRUE(step_until([&] { return feeder.all_received(); }, [&] { process->step(), feeder.beat(); }));
  ServiceStatus last;
  InMemoryBus listener(network_);
  ASSERT_TRUE(listener.subscribe_service_topics());
  EXPECT_TRUE(step_until(
      [&] { return last.last_error.find("unreadable/" + lost + ": it has a value that") != std::string::npos; },
      [&] {
        process->step();
        for (const BusItem& item : listener.receive(std::chrono::milliseconds(5), 1000))
          if (const auto* status = std::get_if<ServiceStatus>(&item); status && status->service == "data_acquisition")
            last = *status;
      }))
      << last.last_error;
  EXPECT_FALSE(process->outputs().empty()) << "the test after it is concluded";
}

TEST_F(RunnerTest, AConclusionThatIsRefusedIsAnAlarmUntilTheNextIsTakenAlsoAfterARestart) {
  RunnerOptions options = fast_options();
  options.assets = {"A"};
  auto process = joiner(options);
  const auto alarms = [&] {
    listener_.listen(milliseconds(5));
    return listener_.statuses.empty() ? std::vector<ServiceAlarm>{} : listener_.statuses.back().alarms;
  };
  const auto step = [&] { process->step(); };
  Message latin_1 = features("p1", 1);
  std::get<TestFeatures>(latin_1).abort_reason = "f\xF6rtidigt";
  send(latin_1);
  ASSERT_TRUE(step_until([&] { return alarms().size() == 1; }, step));
  EXPECT_EQ(alarms().front().kind, "refused_conclusion");
  EXPECT_EQ(alarms().front().asset_id, "A");
  EXPECT_EQ(alarms().front().subject, "test_features");
  EXPECT_EQ(alarms().front().text, "its abort_reason, 'f\\xF6rtidigt', is not UTF-8; send it with a plain name");
  process.reset();
  listener_.statuses.clear();
  process = joiner(options);
  ASSERT_TRUE(step_until([&] { return alarms().size() == 1; }, step)) << "a start mends nothing";
  send(features("p2", 2));
  EXPECT_TRUE(step_until([&] { return alarms().empty(); }, step)) << "return to normal";
  process.reset();
  listener_.statuses.clear();
  process = joiner(options);
  ASSERT_TRUE(step_until([&] { return listener_.listen(), !listener_.statuses.empty(); }, step));
  EXPECT_THAT(alarms(), IsEmpty());
}

TEST_F(RunnerTest, RefusesAReplacementFromTheFutureUnlessTheTestsAreFromThereToo) {
  const auto layer = [] { return std::make_unique<EventLayer>(); };
  constexpr std::int64_t kDay_ns = 86'400'000'000'000;
  const auto event = [](const std::string& id, std::int64_t time_ns) {
    MaintenanceEvent report;
    report.asset_id = "A";
    report.kind = "seal_replaced";
    report.reported_by = "J. Silva";
    report.header = header("maintenance_event/" + id, "");
    report.header.event_time_known = true;
    report.header.event_time_ns = time_ns;
    return report;
  };
  auto process = std::make_unique<Process>(network_, layer, place_.connection());
  process->start();
  const std::int64_t now_ns = process->clock().now().nanoseconds;
  InMemoryBus sender(network_);
  ASSERT_TRUE(sender.publish(Message(event("slip of the year", now_ns + 365 * kDay_ns))));
  ASSERT_TRUE(sender.publish(Message(event("clock ahead", now_ns + kDay_ns / 2))));
  MaintenanceEvent undated = event("some time or other", 0);
  undated.header.event_time_known = false;
  ASSERT_TRUE(sender.publish(Message(undated)));
  step(*process, 3);
  ASSERT_THAT(process->outputs(), SizeIs(1));
  EXPECT_EQ(header_of(process->outputs()[0]).message_id,
            "state_report/" +
                replacement_id_of("maintenance_event/clock ahead", "A", "seal_replaced", {now_ns + kDay_ns / 2}));

  TestFeatures simulated;
  simulated.asset_id = "A";
  simulated.header = header("test_features/a", "a");
  simulated.header.event_time_known = true;
  simulated.header.event_time_ns = now_ns + 1000 * kDay_ns;
  simulated.header.replay = true;
  ASSERT_TRUE(sender.publish(Message(simulated)));
  ASSERT_TRUE(sender.publish(Message(event("in that life", now_ns + 1000 * kDay_ns))));
  step(*process, 3);
  EXPECT_THAT(process->outputs(), SizeIs(2));
  process.reset();
  process = std::make_unique<Process>(network_, layer, place_.connection());
  process->start();
  step(*process, 3);
  EXPECT_THAT(process->outputs(), SizeIs(2)) << "refused once is refused for good";
}

TEST_F(RunnerTest, RefusesATestFarInTheFutureOfALifeThatIsNot) {
  constexpr std::int64_t kDay_ns = 86'400'000'000'000;
  auto process = cutter();
  const std::int64_t now_ns = process->clock().now().nanoseconds;
  auto blocks = blocks_of_tests(6, {"A"});
  blocks.resize(10);
  auto simulated = blocks_of_tests(1, {"B"});
  blocks.insert(blocks.end(), simulated.begin(), simulated.end());
  const std::vector<std::int64_t> days = {-40, 5000, -10, 20, 300, 5000};
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    blocks[k].start_time_known = true;
    blocks[k].start_time_ns = now_ns + days[k / 2] * kDay_ns;
    blocks[k].header.replay = true;
  }
  Feeder feeder(network_, blocks);
  feeder.send(100);
  step(*process, 3);
  std::vector<std::string> tests;
  for (const Message& output : process->outputs())
    if (topic_of(output) == Topic::test_features) tests.push_back(header_of(output).pst_id);
  EXPECT_THAT(tests, ::testing::UnorderedElementsAre("A test 0", "A test 2", "A test 3", "A test 4", "B test 0"));
}

TEST_F(RunnerTest, TakesARefusedTestInOnceItsStartTimeIsCorrected) {
  constexpr std::int64_t kDay_ns = 86'400'000'000'000;
  auto process = cutter();
  const std::int64_t now_ns = process->clock().now().nanoseconds;
  const auto recorded = [&](std::int64_t days) {  // the id of a recording does not tell of its start time
    auto blocks = blocks_of_tests(2, {"A"});
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      blocks[k].header.message_id = "raw_samples/A/" + std::to_string(k);
      blocks[k].start_time_known = true;
      blocks[k].start_time_ns = now_ns + (k < 2 ? -40 : days) * kDay_ns;
    }
    return blocks;
  };
  const auto tests = [&] {
    std::vector<std::string> ids;
    for (const Message& output : process->outputs())
      if (topic_of(output) == Topic::test_features) ids.push_back(header_of(output).pst_id);
    return ids;
  };
  {
    Feeder slip(network_, recorded(5000));
    slip.send(100);
    step(*process, 3);
    EXPECT_THAT(tests(), ElementsAre("A test 0"));
  }
  process.reset();
  process = cutter();            // nor does a restart remember it
  InMemoryBus sender(network_);  // another writer, as each replay is
  for (const RawSamples& block : recorded(-10)) ASSERT_TRUE(sender.publish(Message(block)));
  step(*process, 3);
  EXPECT_THAT(tests(), ElementsAre("A test 0", "A test 1"));
}

TEST_F(RunnerTest, ReceivesWhileItConcludesLaterAndKeepsTheOrderOfAnAsset) {
  Process process(
      network_, [] { return std::make_unique<PatientLayer>(milliseconds(50)); }, place_.connection());
  process.start();
  Feeder feeder(network_, blocks_of_tests(8, {"A", "B"}));
  feeder.send(32);
  step(process, 3);
  EXPECT_EQ(process.journal().open_inputs(), 32U) << "all are received before the first is concluded from";
  ASSERT_TRUE(step_until([&] { return process.outputs().size() == 16; }, [&] { process.step(); }));
  std::map<std::string, std::vector<std::string>> order;
  for (const Message& output : process.outputs()) order[asset_of(output)].push_back(header_of(output).pst_id);
  for (const std::string asset : {"A", "B"}) {
    std::vector<std::string> tests;
    for (int test = 0; test < 8; ++test) tests.push_back(asset + " test " + std::to_string(test));
    EXPECT_EQ(order[asset], tests);
  }
  EXPECT_EQ(process.journal().open_inputs(), 0U);
}

TEST_F(RunnerTest, ConcludesAgainWhatAStopLeftForLater) {
  const auto slow = [] { return std::make_unique<PatientLayer>(milliseconds(50)); };
  {
    Process process(network_, slow, place_.connection());
    process.start();
    Feeder feeder(network_, blocks_of_tests(1, {"A", "B"}));
    feeder.send(4);
    step(process, 2);
    EXPECT_THAT(process.outputs(), IsEmpty());
  }
  Process process(network_, slow, place_.connection());
  process.start();
  EXPECT_TRUE(step_until([&] { return process.outputs().size() == 2; }, [&] { process.step(); }));
  EXPECT_EQ(process.journal().open_inputs(), 0U);
}

TEST_F(RunnerTest, SaysHowFarItsStreamsGoAndThatItStops) {
  {
    auto process = cutter();
    Feeder feeder(network_, blocks_of_tests(2, {"A"}));
    feeder.send(4);
    step(*process, 3);
    ASSERT_TRUE(step_until([&] { return !listener_.statuses.empty() && listener_.statuses.back().written.size() == 3; },
                           [&] { listener_.listen(milliseconds(5)); }));
    const std::string writer = process->journal().writer_id();
    EXPECT_THAT(listener_.statuses.back().written,
                ElementsAre(StreamPosition{"test_features", writer, 2}, StreamPosition{"state_report", writer, 2},
                            StreamPosition{"act_record", writer, 0}));
    EXPECT_EQ(listener_.statuses.back().state, "running");
  }
  listener_.listen();
  EXPECT_EQ(listener_.statuses.back().state, "stopping");
}

TEST_F(RunnerTest, SaysThatAnotherOfItsKindRunsInTheDomain) {
  auto process = cutter();
  const std::string writer = process->journal().writer_id();
  InMemoryBus other(network_);
  ServiceStatus rival;
  rival.service = "data_acquisition";
  rival.writer_id = writer;  // itself
  rival.process_id = 4710;
  rival.state = "running";
  ASSERT_TRUE(other.publish(rival));
  rival.writer_id = "rival";
  rival.process_id = 4711;
  ASSERT_TRUE(other.publish(rival));
  step(*process, 3);
  const auto said = [&] {
    return std::ranges::any_of(listener_.statuses, [&](const ServiceStatus& status) {
      return status.writer_id == writer &&
             status.last_error.starts_with("another data_acquisition, process 4711, runs in this domain");
    });
  };
  EXPECT_TRUE(step_until(said, [&] { listener_.listen(milliseconds(5)); }));
}

TEST(ClockWatch, TellsAStepUntilItIsMendedOrAnHourOld) {
  using std::chrono::hours;
  using std::chrono::minutes;
  using std::chrono::seconds;
  const auto at = [](ClockWatch& watch, std::chrono::nanoseconds steady, double offset_s) {
    return watch.look(add_seconds(UtcTime{1'900'000'000'000'000'000 + steady.count()}, offset_s), steady);
  };
  ClockWatch watch;
  EXPECT_FALSE(at(watch, seconds(5), 0.0)) << "where it is at the start is taken as it is";
  EXPECT_FALSE(at(watch, hours(5), 0.9)) << "slewed";
  EXPECT_TRUE(at(watch, hours(6), 7200.9));
  EXPECT_NEAR(watch.step_s().value(), 7200.0, 0.1);
  EXPECT_FALSE(at(watch, hours(6) + minutes(1), 7200.9)) << "it stands";
  EXPECT_TRUE(at(watch, hours(6) + minutes(2), 0.9));
  EXPECT_FALSE(watch.step_s()) << "set back to where it was";
  EXPECT_TRUE(at(watch, hours(7), -100.0));
  EXPECT_NEAR(watch.step_s().value(), -100.9, 0.1);
  EXPECT_FALSE(at(watch, hours(8), -100.0));
  EXPECT_TRUE(at(watch, hours(8) + seconds(1), -100.0)) << "an hour without another";
  EXPECT_FALSE(watch.step_s());
}

TEST(ClockWatch, AClockBehindWhatWasWrittenWasSetBackBeforeTheStart) {
  using std::chrono::seconds;
  const UtcTime begin{1'900'000'000'000'000'000};
  ClockWatch watch;
  watch.begin(add_seconds(begin, 7200.0), begin, seconds(0));
  EXPECT_NEAR(watch.step_s().value(), -7200.0, 0.1);
  EXPECT_FALSE(watch.look(add_seconds(begin, 1.0), seconds(1)));
  EXPECT_TRUE(watch.look(add_seconds(begin, 9000.0), seconds(2))) << "how long the machine was off, nobody knows";
  EXPECT_FALSE(watch.step_s());
  ClockWatch late;
  late.begin(begin, add_seconds(begin, 86400.0), seconds(0));
  EXPECT_FALSE(late.step_s());
}

TEST_F(RunnerTest, TellsAtItsStartAClockThatIsBehindItsJournal) {
  RunnerOptions options = fast_options();
  options.watches_clock = true;
  {
    Process process(network_, cutting, place_.connection(), Fate(), options);
    process.start();
    ASSERT_TRUE(process.journal().begin());
    ASSERT_TRUE(process.journal().add_input(SampleBlock{}, process.clock().now(), true));
    ASSERT_TRUE(process.journal().commit());
  }
  Process process(network_, cutting, place_.connection(), Fate(), options);
  process.clock().set(add_seconds(process.clock().now(), -7200.0));
  process.start();
  const auto alarms = [&] {
    listener_.listen(milliseconds(5));
    return listener_.statuses.empty() ? std::vector<ServiceAlarm>{} : listener_.statuses.back().alarms;
  };
  ASSERT_TRUE(step_until([&] { return !alarms().empty(); }, [&] { process.step(); }));
  EXPECT_EQ(alarms().front().kind, "clock_step");
  EXPECT_THAT(alarms().front().text, HasSubstr("set back by 7200 s"));
}

TEST_F(RunnerTest, TellsAClockThatWasSetAsAnAlarmUntilItIsSetBack) {
  RunnerOptions options = fast_options();
  options.watches_clock = true;
  Process process(network_, cutting, place_.connection(), Fate(), options);
  process.start();
  const UtcTime begin = process.clock().now();
  const auto steady_begin = std::chrono::steady_clock::now();
  double set_by_s = 0.0;
  const auto step = [&] {
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - steady_begin;
    process.clock().set(add_seconds(begin, elapsed.count() + set_by_s));
    process.step();
  };
  const auto alarms = [&] {
    listener_.listen(milliseconds(5));
    return listener_.statuses.empty() ? std::vector<ServiceAlarm>{} : listener_.statuses.back().alarms;
  };
  step();
  EXPECT_THAT(alarms(), IsEmpty());
  set_by_s = -3600.0;
  ASSERT_TRUE(step_until([&] { return alarms().size() == 1; }, step));
  EXPECT_EQ(alarms().front().kind, "clock_step");
  EXPECT_THAT(alarms().front().text, HasSubstr("set back by 3600 s"));
  set_by_s = 0.0;
  EXPECT_TRUE(step_until([&] { return alarms().empty(); }, step)) << "return to normal";
}

TEST_F(RunnerTest, AJournalThatCannotBeWrittenStopsItBeforeAnythingIsPublished) {
  const std::string patient = "sqlite3://timeout=1 dbname=" + (place_.directory() / "journal.db").string();
  Process process(network_, cutting, patient);
  process.start();
  soci::session other(place_.connection());
  other << "BEGIN IMMEDIATE";
  Feeder feeder(network_, blocks_of_tests(1, {"A"}));
  feeder.send(2);
  const Status stepped = process.try_step();
  ASSERT_FALSE(stepped);
  EXPECT_THAT(stepped.error().describe(), HasSubstr("locked"));
  other << "ROLLBACK";
  EXPECT_THAT(listener_.sequences(Topic::test_features), IsEmpty());
}

}  // namespace
}  // namespace sealwatch::testing
