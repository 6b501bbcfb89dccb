#include "services/cli/replay_feeder.hpp"

#include <gtest/gtest.h>

#include "tests/unit/port/in_memory_bus.hpp"

namespace sealwatch::cli {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

/// `tests` tests of two blocks, one second each.
std::function<std::vector<RawSamples>()> source(int tests) {
  return [made = 0, tests]() mutable {
    std::vector<RawSamples> blocks;
    if (made == tests) return blocks;
    ++made;
    for (int k = 0; k < 2; ++k) {
      RawSamples block;
      block.asset_id = "A";
      block.recording_id = "test " + std::to_string(made);
      block.block_number = static_cast<std::uint64_t>(k);
      block.boundary = k == 0 ? BlockBoundary::begin : BlockBoundary::end;
      block.samples.time_s = {0.0 + k, 1.0 + k};
      blocks.push_back(block);
    }
    return blocks;
  };
}

ServiceStatus journaled(const std::string& writer, std::uint64_t sequence) {
  ServiceStatus status;
  status.service = "data_acquisition";
  status.received = {{.topic = "raw_samples", .writer_id = writer, .sequence = sequence}};
  return status;
}

class Feeder : public ::testing::Test {
 protected:
  Feeder() {
    const std::array topics = {Topic::raw_samples};
    EXPECT_TRUE(reader_.subscribe(topics).has_value());
  }
  /// Sequence numbers that arrived since the last call.
  std::vector<std::uint64_t> arrived() {
    std::vector<std::uint64_t> sequences;
    for (const BusItem& item : reader_.receive(milliseconds(0), 100))
      sequences.push_back(header_of(std::get<Message>(item)).stream_sequence);
    return sequences;
  }
  std::shared_ptr<InMemoryNetwork> network_ = std::make_shared<InMemoryNetwork>();
  InMemoryBus writer_{network_};
  InMemoryBus reader_{network_};
};

TEST_F(Feeder, StaysAFewTestsAheadOfWhatIsJournaled) {
  ReplayFeeder feeder("w", source(3), 1, 0.0);
  feeder.feed(writer_, steady_clock::now());
  EXPECT_EQ(arrived(), (std::vector<std::uint64_t>{1, 2}));
  feeder.feed(writer_, steady_clock::now());
  EXPECT_TRUE(arrived().empty()) << "the first test is not journaled yet";
  feeder.take(journaled("w", 2));
  feeder.feed(writer_, steady_clock::now());
  EXPECT_EQ(arrived(), (std::vector<std::uint64_t>{3, 4}));
}

TEST_F(Feeder, StaysAStreamsWindowAheadHoweverLongATestIs) {
  ReplayFeeder feeder(
      "w", [] { return std::vector<RawSamples>(1000); }, 6, 0.0);
  feeder.feed(writer_, steady_clock::now());
  EXPECT_EQ(arrived().size(), 100U);  // as many as `arrived` takes
  EXPECT_EQ(arrived().size(), 28U);
  feeder.take(journaled("w", 10));
  feeder.feed(writer_, steady_clock::now());
  EXPECT_EQ(arrived().size(), 10U);
}

TEST_F(Feeder, KeepsWhatTheBusDoesNotTakeForTheNextTime) {
  class FullBus final : public Bus {
   public:
    Status subscribe(std::span<const Topic> /*topics*/) override { return {}; }
    Status subscribe_service_topics() override { return {}; }
    Status publish(const Message& /*message*/) override { return fail("is full"); }
    Status publish(const ServiceStatus& /*status*/) override { return {}; }
    Status publish(const ResendRequest& /*request*/) override { return {}; }
    std::vector<BusItem> receive(milliseconds /*timeout*/, std::size_t /*most*/) override { return {}; }
    void wake() override {}
  } full;
  ReplayFeeder feeder("w", source(1), 1, 0.0);
  feeder.feed(full, steady_clock::now());
  EXPECT_FALSE(feeder.done());
  EXPECT_EQ(feeder.not_taken(), "is full");
  feeder.feed(writer_, steady_clock::now());
  EXPECT_EQ(arrived(), (std::vector<std::uint64_t>{1, 2}));
  EXPECT_EQ(feeder.not_taken(), "");
}

TEST_F(Feeder, SendsAgainWhatIsNotJournaledForSomeSeconds) {
  ReplayFeeder feeder("w", source(1), 1, 0.0);
  const auto start = steady_clock::now();
  const auto feed_at = [&](int ms) { feeder.feed(writer_, start + milliseconds(ms)); };
  feed_at(0);
  feed_at(20);
  EXPECT_EQ(arrived(), (std::vector<std::uint64_t>{1, 2}));
  feeder.take(journaled("w", 1));  // the last block was lost with the service that had received it
  feed_at(2900);
  feed_at(5800);
  EXPECT_TRUE(arrived().empty()) << "it has just journaled something";
  feed_at(6000);
  EXPECT_EQ(arrived(), std::vector<std::uint64_t>{2});
  feed_at(6100);
  EXPECT_TRUE(arrived().empty()) << "not at once again";
  feeder.take(journaled("w", 2));
  feed_at(60000);
  EXPECT_TRUE(arrived().empty());
  EXPECT_TRUE(feeder.done());
}

TEST_F(Feeder, HearsOnceThatATestWasRefusedAndNotOfWhatWasRefusedBefore) {
  ReplayFeeder feeder("w", source(1), 1, 0.0);
  ServiceStatus status = journaled("w", 0);
  status.last_error = "2026-01-01T00:00:00Z raw_samples refused: recording PST-7 of A: its start time";
  feeder.take(status);
  feeder.feed(writer_, steady_clock::now());
  feeder.take(status);
  EXPECT_TRUE(feeder.take_refusals().empty()) << "of another replay";
  status.last_error = "2026-01-01T00:00:05Z raw_samples refused: recording PST-8 of A: it is now 5 s";
  feeder.take(status);
  EXPECT_EQ(feeder.take_refusals(), std::vector<std::string>{"recording PST-8 of A: it is now 5 s"});
  status.last_error = "2026-01-01T00:00:06Z raw_samples refused: recording PST-8 of A: it is now 6 s";
  feeder.take(status);
  EXPECT_TRUE(feeder.take_refusals().empty()) << "its next block";
}

TEST_F(Feeder, SendsAgainWhatIsMissed) {
  ReplayFeeder feeder("w", source(1), 1, 0.0);
  feeder.feed(writer_, steady_clock::now());
  (void)arrived();
  const ResendRequest request{
      .writer_id = "w", .topic = "raw_samples", .first_sequence = 2, .last_sequence = 9, .requested_by = "x"};
  feeder.take(request, writer_);
  EXPECT_EQ(arrived(), (std::vector<std::uint64_t>{2}));
  ResendRequest other = request;
  other.writer_id = "somebody else";
  feeder.take(other, writer_);
  EXPECT_TRUE(arrived().empty());
}

TEST_F(Feeder, IsDoneWhenTheLastBlockIsJournaled) {
  ReplayFeeder feeder("w", source(1), 2, 0.0);
  feeder.feed(writer_, steady_clock::now());
  feeder.take(journaled("w", 1));
  EXPECT_FALSE(feeder.done());
  feeder.take(journaled("w", 2));
  EXPECT_TRUE(feeder.done());
}

TEST_F(Feeder, KeepsTheRecordedPace) {
  ReplayFeeder feeder("w", source(1), 1, 2.0);
  const auto start = steady_clock::now();
  feeder.feed(writer_, start);
  EXPECT_TRUE(arrived().empty()) << "the first block ends after one recorded second";
  feeder.feed(writer_, start + milliseconds(501));
  EXPECT_EQ(arrived(), (std::vector<std::uint64_t>{1}));
  feeder.feed(writer_, start + milliseconds(1001));
  EXPECT_EQ(arrived(), (std::vector<std::uint64_t>{2}));
}

using Inputs = std::map<std::string, std::vector<std::string>>;

ServiceStatus status(const std::string& service, std::uint64_t pending, std::vector<StreamPosition> written,
                     std::vector<StreamPosition> received) {
  ServiceStatus result;
  result.service = service;
  result.writer_id = service;
  result.pending_inputs = pending;
  result.written = std::move(written);
  result.received = std::move(received);
  return result;
}

TEST(Quiescence, IsReachedWhenEveryStreamIsReadToItsEnd) {
  const Inputs inputs = {{"first", {"raw_samples"}}, {"second", {"test_window"}}};
  Quiescence quiescence(inputs);
  EXPECT_EQ(quiescence.missing(), (std::vector<std::string>{"first", "second"}));
  quiescence.take(status("first", 0, {{"test_window", "first", 5}}, {{"raw_samples", "w", 7}}));
  quiescence.take(status("second", 0, {}, {{"test_window", "first", 3}}));
  EXPECT_TRUE(quiescence.missing().empty());
  EXPECT_FALSE(quiescence.reached("w", 7));
  EXPECT_FALSE(quiescence.keeps_up(2));
  EXPECT_TRUE(quiescence.keeps_up(3));
  quiescence.take(status("second", 1, {}, {{"test_window", "first", 5}}));
  EXPECT_FALSE(quiescence.reached("w", 7)) << "an input is still waiting";
  quiescence.take(status("second", 0, {}, {{"test_window", "first", 5}}));
  EXPECT_TRUE(quiescence.reached("w", 7));
  EXPECT_FALSE(quiescence.reached("w", 8)) << "the source goes further than what was received";
  EXPECT_TRUE(quiescence.keeps_up(1));
}

/// A mismatch analysis takes minutes, in which nothing comes; of a service that is dead nothing will.
TEST(Quiescence, KnowsAServiceThatConcludesFromOneThatIsDead) {
  Quiescence quiescence({{"first", {"raw_samples"}}, {"second", {"test_window"}}});
  Quiescence::Time now{};
  quiescence.take(status("second", 3, {}, {}), now);
  EXPECT_FALSE(quiescence.is_concluding(now)) << "the first was never heard";
  quiescence.take(status("first", 0, {}, {}), now);
  EXPECT_TRUE(quiescence.is_concluding(now));
  now += Quiescence::kSilent;
  quiescence.take(status("second", 3, {}, {}), now);
  EXPECT_FALSE(quiescence.is_concluding(now)) << "the first is silent";
  quiescence.take(status("first", 0, {}, {}), now);
  quiescence.take(status("second", 0, {}, {}), now);
  EXPECT_FALSE(quiescence.is_concluding(now)) << "nothing is waiting";
}

TEST(Quiescence, DoesNotWaitForInputsThatLayAroundBefore) {
  const Inputs inputs = {{"first", {"raw_samples"}}};
  Quiescence quiescence(inputs);
  const Quiescence::Time start{};
  quiescence.take(status("first", 2, {}, {}), start);
  quiescence.take(status("first", 2, {}, {{"raw_samples", "w", 1}}), start + Quiescence::kStill);
  EXPECT_TRUE(quiescence.reached("w", 1, start + Quiescence::kStill));
}

/// Replay ended well while a service was still busy with what somebody had flooded it with before.
TEST(Quiescence, WaitsWhileInputsThatLayAroundBeforeBecomeLess) {
  const Inputs inputs = {{"first", {"raw_samples"}}};
  Quiescence quiescence(inputs);
  Quiescence::Time now{};
  const auto heard = [&](std::uint64_t pending) {
    now += std::chrono::seconds(1);
    quiescence.take(status("first", pending, {}, {{"raw_samples", "w", 1}}), now);
    return quiescence.reached("w", 1, now);
  };
  for (const std::uint64_t pending : {6000U, 4000U, 2000U, 5U, 3U}) EXPECT_FALSE(heard(pending)) << pending;
  for (int k = 0; k < 10; ++k) EXPECT_FALSE(heard(4)) << "one of its own is under way";
  EXPECT_FALSE(heard(3));
  EXPECT_FALSE(heard(3));
  EXPECT_FALSE(heard(3));
  EXPECT_TRUE(heard(3)) << "they stay";
  EXPECT_TRUE(heard(0));
}

}  // namespace
}  // namespace sealwatch::cli
