// Both sides of the stream protocol, without a bus.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "services/common/runtime/resend_queue.hpp"
#include "services/common/runtime/stream_reader.hpp"

namespace sealwatch {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

Message numbered(std::uint64_t sequence, const std::string& writer = "w") {
  Advisory advisory;
  advisory.header.writer_id = writer;
  advisory.header.stream_sequence = sequence;
  return advisory;
}

std::vector<std::uint64_t> sequences(const std::vector<Message>& messages) {
  std::vector<std::uint64_t> found;
  for (const Message& message : messages) found.push_back(header_of(message).stream_sequence);
  return found;
}

class StreamReaderTest : public ::testing::Test {
 protected:
  std::vector<std::uint64_t> accept(std::uint64_t sequence) { return sequences(reader_.accept(numbered(sequence))); }
  /// First and last sequence that are asked for at `now_s`, or nothing.
  std::vector<std::uint64_t> asked(double now_s) {
    const auto requests = reader_.requests(now_s);
    if (requests.empty()) return {};
    EXPECT_EQ(requests.size(), 1U);
    EXPECT_EQ(requests[0].topic, "advisory");
    EXPECT_EQ(requests[0].writer_id, "w");
    EXPECT_EQ(requests[0].requested_by, "reader");
    return {requests[0].first_sequence, requests[0].last_sequence};
  }
  bool note(std::uint64_t written, double now_s) { return reader_.note_written({"advisory", "w", written}, now_s); }

  StreamReader::Limits limits_{
      .held = 4, .window = 10, .patience_s = 0.3, .retry_s = 1.0, .longest_retry_s = 4.0, .set_back_s = 5.0};
  StreamReader reader_{"reader", {{"advisory", "w", 2}}, limits_};
};

TEST_F(StreamReaderTest, HandsOutInOrderOnceFromItsPositionOn) {
  EXPECT_THAT(accept(1), IsEmpty());
  EXPECT_THAT(accept(2), IsEmpty());
  EXPECT_THAT(accept(3), ElementsAre(3));
  EXPECT_THAT(accept(3), IsEmpty());
  EXPECT_THAT(accept(4), ElementsAre(4));
}

TEST_F(StreamReaderTest, AStreamNeverHeardOfStartsAtOne) {
  EXPECT_THAT(sequences(reader_.accept(numbered(2, "new"))), IsEmpty());
  EXPECT_THAT(sequences(reader_.accept(numbered(1, "new"))), ElementsAre(1, 2));
}

TEST_F(StreamReaderTest, WhatLiesBeyondAGapWaitsUntilItIsFilled) {
  EXPECT_THAT(accept(5), IsEmpty());
  EXPECT_THAT(accept(4), IsEmpty());
  EXPECT_THAT(accept(3), ElementsAre(3, 4, 5));
}

TEST_F(StreamReaderTest, HoldsBackABoundedNumberAndAsksForTheRestLater) {
  for (std::uint64_t sequence = 4; sequence <= 20; ++sequence) EXPECT_THAT(accept(sequence), IsEmpty());
  EXPECT_THAT(accept(3), ElementsAre(3, 4, 5, 6, 7));
  EXPECT_THAT(asked(0.0), IsEmpty());
  EXPECT_THAT(asked(0.4), ElementsAre(8, 17));
}

TEST_F(StreamReaderTest, AsksForAGapAfterPatienceAndNotMoreOftenThanItMay) {
  EXPECT_THAT(asked(0.0), IsEmpty()) << "nothing is missing";
  accept(6);
  EXPECT_THAT(asked(1.0), IsEmpty());
  EXPECT_THAT(asked(1.2), IsEmpty());
  EXPECT_THAT(asked(1.4), ElementsAre(3, 5));
  EXPECT_THAT(asked(2.3), IsEmpty());
  EXPECT_THAT(asked(2.5), ElementsAre(3, 5)) << "no answer: again after a second";
  EXPECT_THAT(asked(4.4), IsEmpty());
  EXPECT_THAT(asked(4.6), ElementsAre(3, 5)) << "then after two";
  EXPECT_THAT(asked(8.7), ElementsAre(3, 5)) << "then after four";
  EXPECT_THAT(asked(12.8), ElementsAre(3, 5)) << "never more rarely than that";
}

TEST_F(StreamReaderTest, AsksOftenAgainOnceTheWriterIsThere) {
  accept(6);
  EXPECT_THAT(asked(0.0), IsEmpty());
  EXPECT_THAT(asked(1.0), ElementsAre(3, 5));
  EXPECT_THAT(asked(2.1), ElementsAre(3, 5));
  EXPECT_THAT(asked(4.2), ElementsAre(3, 5));
  note(6, 5.0);
  EXPECT_THAT(asked(5.3), ElementsAre(3, 5));
}

TEST_F(StreamReaderTest, AHeartbeatShowsWhatIsMissingAtTheEnd) {
  note(4, 0.0);
  EXPECT_THAT(asked(0.0), IsEmpty());
  EXPECT_THAT(asked(0.4), ElementsAre(3, 4));
  accept(3);
  EXPECT_THAT(accept(4), ElementsAre(4));
  EXPECT_THAT(asked(9.0), IsEmpty());
}

TEST_F(StreamReaderTest, ProgressResetsPatience) {
  note(9, 0.0);
  EXPECT_THAT(asked(0.0), IsEmpty());
  accept(3);
  EXPECT_THAT(asked(0.4), IsEmpty()) << "messages are coming in by themselves";
  EXPECT_THAT(asked(0.8), ElementsAre(4, 9));
}

TEST_F(StreamReaderTest, ALongStretchIsAskedForWindowByWindowWithoutDelay) {
  note(25, 0.0);
  EXPECT_THAT(asked(0.0), IsEmpty());
  EXPECT_THAT(asked(0.4), ElementsAre(3, 12));
  for (std::uint64_t sequence = 3; sequence <= 12; ++sequence) accept(sequence);
  EXPECT_THAT(asked(0.41), ElementsAre(13, 22));
  for (std::uint64_t sequence = 13; sequence <= 22; ++sequence) accept(sequence);
  EXPECT_THAT(asked(0.42), ElementsAre(23, 25));
}

TEST_F(StreamReaderTest, AWriterThatWasSetBackIsReadAgainFromItsStart) {
  EXPECT_FALSE(note(1, 0.0)) << "one heartbeat may be older than the messages";
  EXPECT_FALSE(note(1, 4.9));
  EXPECT_TRUE(note(1, 5.1));
  EXPECT_THAT(accept(1), ElementsAre(1));
}

TEST_F(StreamReaderTest, AHeartbeatThatIsOnlyLateSetsNothingBack) {
  EXPECT_FALSE(note(1, 0.0));
  EXPECT_FALSE(note(2, 3.0));
  EXPECT_FALSE(note(1, 5.1));
  EXPECT_THAT(accept(1), IsEmpty());
}

TEST_F(StreamReaderTest, AnyDisorderWithRepetitionComesOutInOrderOnce) {
  std::mt19937 random(7);
  for (int round = 0; round < 50; ++round) {
    StreamReader reader("reader", {}, limits_);
    std::vector<std::uint64_t> got;
    std::uniform_int_distribution<std::uint64_t> any(1, 30);
    double now_s = 0.0;
    while (got.size() < 30) {
      for (const auto sequence : sequences(reader.accept(numbered(any(random))))) got.push_back(sequence);
      reader.note_written({"advisory", "w", 30}, now_s += 0.01);
    }
    std::vector<std::uint64_t> expected(30);
    for (std::size_t k = 0; k < 30; ++k) expected[k] = k + 1;
    ASSERT_EQ(got, expected);
  }
}

using Range = ResendQueue::Range;

TEST(ResendQueueTest, ServesBoundedPieces) {
  ResendQueue queue;
  queue.add({Topic::advisory, 1, 150});
  EXPECT_EQ(queue.take(64), (Range{Topic::advisory, 1, 64}));
  EXPECT_EQ(queue.take(64), (Range{Topic::advisory, 65, 128}));
  EXPECT_EQ(queue.take(64), (Range{Topic::advisory, 129, 150}));
  EXPECT_EQ(queue.take(64), std::nullopt);
}

TEST(ResendQueueTest, ServesSeveralReadersThatMissTheSameOnce) {
  ResendQueue queue;
  queue.add({Topic::advisory, 1, 10});
  queue.add({Topic::advisory, 5, 20});
  queue.add({Topic::advisory, 21, 22});
  queue.add({Topic::state_report, 5, 6});
  EXPECT_EQ(queue.take(64), (Range{Topic::advisory, 1, 22}));
  EXPECT_EQ(queue.take(64), (Range{Topic::state_report, 5, 6}));
  EXPECT_TRUE(queue.empty());
}

TEST(ResendQueueTest, TakesTopicsInTurn) {
  ResendQueue queue;
  queue.add({Topic::advisory, 1, 100});
  queue.add({Topic::state_report, 1, 1});
  EXPECT_EQ(queue.take(64)->topic, Topic::advisory);
  EXPECT_EQ(queue.take(64)->topic, Topic::state_report);
  EXPECT_EQ(queue.take(64)->topic, Topic::advisory);
}

TEST(ResendQueueTest, PassesOverWhatIsEmpty) {
  ResendQueue queue;
  queue.add({Topic::advisory, 5, 4});
  EXPECT_TRUE(queue.empty());
}

}  // namespace
}  // namespace sealwatch
