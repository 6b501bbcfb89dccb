// Both sides of the stream protocol, without a bus.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "services/common/runtime/resend_queue.hpp"
#include "services/common/runtime/stream_reader.hpp"
#include "services/common/runtime/stream_window.hpp"

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

constexpr std::uint64_t kHighest = std::numeric_limits<std::uint64_t>::max();

TEST_F(StreamReaderTest, AForgedWordOnHowFarAStreamGoesIsWaitedForAMinuteAndTakenBack) {
  note(kHighest, 0.0);
  EXPECT_TRUE(reader_.is_behind());
  EXPECT_THAT(asked(0.0), IsEmpty());
  EXPECT_THAT(asked(0.4), ElementsAre(3, 12));
  for (double now_s = 1.0; now_s < 70.0; now_s += 0.5) {
    note(kHighest, now_s);
    (void)asked(now_s);
  }
  EXPECT_FALSE(reader_.is_behind()) << "time stands still for ever";
  int requests = 0;
  for (double now_s = 70.0; now_s < 170.0; now_s += 0.5) {
    note(kHighest, now_s);
    requests += asked(now_s).empty() ? 0 : 1;
  }
  EXPECT_LE(requests, 27) << "at most every 4 s";
  EXPECT_GE(requests, 20) << "it may be true";
  note(3, 170.0);
  EXPECT_THAT(accept(3), ElementsAre(3));
  EXPECT_THAT(asked(300.0), IsEmpty()) << "the writer's own word counts";
  note(4, 301.0);
  EXPECT_TRUE(reader_.is_behind());
}

TEST_F(StreamReaderTest, AForgedNumberStopsNobody) {
  EXPECT_THAT(accept(kHighest), IsEmpty());
  EXPECT_THAT(accept(3), ElementsAre(3));
  for (double now_s = 0.0; now_s < 70.0; now_s += 0.5) {
    note(3, now_s);
    (void)asked(now_s);
  }
  EXPECT_FALSE(reader_.is_behind());
  EXPECT_THAT(asked(1000.0), IsEmpty()) << "forgotten";
  EXPECT_THAT(accept(4), ElementsAre(4));
}

TEST_F(StreamReaderTest, AWriterThatDiedInAGapIsAskedForButNotWaitedFor) {
  EXPECT_THAT(accept(5), IsEmpty());
  for (double now_s = 0.0; now_s < 70.0; now_s += 0.5) (void)asked(now_s);
  EXPECT_FALSE(reader_.is_behind());
  EXPECT_THAT(asked(100.0), ElementsAre(3, 4)) << "it may come back";
  EXPECT_THAT(accept(3), ElementsAre(3));
  EXPECT_THAT(accept(4), ElementsAre(4, 5)) << "nothing was lost";
}

/// A sender whose confirmed blocks were lost with the journal: it has them no more, and does not know.
TEST_F(StreamReaderTest, WhatASenderDoesNotAnswerForIsToldWhileLaterBlocksWait) {
  const auto block = [](std::uint64_t sequence) {
    RawSamples samples;
    samples.header.writer_id = "mcs";
    samples.header.stream_sequence = sequence;
    return Message(samples);
  };
  auto repeats_until = [&, now_s = 0.0](double end_s) mutable {
    for (; now_s < end_s; now_s += 1.0) {
      EXPECT_THAT(reader_.accept(block(4)), IsEmpty());
      (void)reader_.requests(now_s);
    }
  };
  repeats_until(59.0);
  EXPECT_THAT(reader_.missing_of_senders(), IsEmpty());
  repeats_until(62.0);
  ASSERT_EQ(reader_.missing_of_senders().size(), 1U);
  EXPECT_EQ(reader_.missing_of_senders()[0].writer_id, "mcs");
  EXPECT_EQ(reader_.missing_of_senders()[0].first, 1U);
  EXPECT_EQ(reader_.missing_of_senders()[0].last, 3U);
  (void)reader_.requests(80.0);
  EXPECT_THAT(reader_.missing_of_senders(), IsEmpty()) << "it goes on under another name";
  for (const std::uint64_t sequence : {1, 2, 3, 4}) (void)reader_.accept(block(sequence));
  EXPECT_THAT(reader_.missing_of_senders(), IsEmpty()) << "they came";
}

/// What came while the process was stopped is still on the bus, and so is what its writer beats of.
TEST_F(StreamReaderTest, AReaderThatWasStoppedForLongHasWaitedForNothing) {
  note(3, 0.0);
  EXPECT_THAT(asked(0.0), IsEmpty());
  note(9, 600.0);
  EXPECT_THAT(asked(600.0), ElementsAre(3, 9));
  EXPECT_TRUE(reader_.is_behind()) << "a test would be taken for cut whose blocks wait on the bus";
  EXPECT_THAT(reader_.missing_of_services("advisory"), IsEmpty());
}

/// DDS matches no reader that asks for more than its writer offers: of all that one, nothing comes, however it is
/// asked.
TEST_F(StreamReaderTest, WhatOfAServiceThatBeatsDoesNotComeIsTold) {
  auto beats_until = [&, now_s = 0.0](double end_s) mutable {
    for (; now_s < end_s; now_s += 1.0) {
      (void)reader_.note_written({"sample_block", "data_acquisition-1", 7}, now_s);
      (void)reader_.requests(now_s);
    }
  };
  beats_until(59.0);
  EXPECT_THAT(reader_.missing_of_services("sample_block"), IsEmpty());
  beats_until(63.0);
  ASSERT_EQ(reader_.missing_of_services("sample_block").size(), 1U);
  EXPECT_EQ(reader_.missing_of_services("sample_block")[0].writer_id, "data_acquisition-1");
  EXPECT_EQ(reader_.missing_of_services("sample_block")[0].last, 7U);
  EXPECT_THAT(reader_.missing_of_services("test_window"), IsEmpty());
  (void)reader_.requests(90.0);
  EXPECT_THAT(reader_.missing_of_services("sample_block"), IsEmpty()) << "the service is silent: that is another alarm";
}

/// So many are missing that not even the later ones are held.
TEST_F(StreamReaderTest, AGapOfAnySizeIsTold) {
  RawSamples samples;
  samples.header.writer_id = "mcs";
  samples.header.stream_sequence = 5000;
  for (double now_s = 0.0; now_s < 62.0; now_s += 1.0) {
    EXPECT_THAT(reader_.accept(samples), IsEmpty());
    (void)reader_.requests(now_s);
  }
  ASSERT_EQ(reader_.missing_of_senders().size(), 1U);
  EXPECT_EQ(reader_.missing_of_senders()[0].last, 4999U);
}

TEST_F(StreamReaderTest, ANumberedSourceThatDiesAfterItsLastBlockLeavesNothingOpen) {
  EXPECT_THAT(accept(3), ElementsAre(3));
  EXPECT_FALSE(reader_.is_behind());
  EXPECT_THAT(asked(1000.0), IsEmpty());
}

TEST_F(StreamReaderTest, TheHighestNumberThereIsIsANumber) {
  StreamReader reader("reader", {{"advisory", "w", kHighest - 1}}, limits_);
  EXPECT_THAT(sequences(reader.accept(numbered(kHighest))), ElementsAre(kHighest));
  EXPECT_THAT(sequences(reader.accept(numbered(kHighest))), IsEmpty());
  EXPECT_THAT(sequences(reader.accept(numbered(1))), IsEmpty());
  reader.note_written({"advisory", "w", kHighest}, 1.0);
  EXPECT_THAT(reader.requests(2.0), IsEmpty());
}

TEST_F(StreamReaderTest, StrangersAreBoundedAndForgottenAndTheOwnWritersStay) {
  const auto stranger = [](int k) { return "stranger " + std::to_string(k); };
  for (int k = 0; k < 100'000; ++k) reader_.note_written({"advisory", stranger(k), 7}, 0.0);
  EXPECT_EQ(reader_.active().size(), 0U) << "of nobody anything was read";
  EXPECT_THAT(accept(3), ElementsAre(3));
  std::size_t asked_at_once = 0;
  for (double now_s = 0.0; now_s < 5.0; now_s += 0.1)
    asked_at_once = std::max(asked_at_once, reader_.requests(now_s).size());
  EXPECT_LE(asked_at_once, limits_.requests);
  note(3, 120.0);
  EXPECT_THAT(sequences(reader_.accept(numbered(1, "newcomer"))), ElementsAre(1));
  EXPECT_EQ(reader_.active().size(), 2U);
  note(3, 800.0);
  EXPECT_EQ(reader_.active().size(), 1U) << "who was not heard for ten minutes is not spoken of";
}

TEST_F(StreamReaderTest, WhenAWriterStartsTheLastMessagesReadAreAskedForAgain) {
  note(2, 0.0);
  EXPECT_THAT(asked(0.0), IsEmpty());
  (void)reader_.note_start("w", 111, 0.0);
  EXPECT_THAT(asked(0.1), ElementsAre(1, 2));
  EXPECT_THAT(asked(0.2), IsEmpty());
  EXPECT_THAT(asked(1.2), ElementsAre(1, 2)) << "no answer";
  EXPECT_THAT(accept(2), IsEmpty());
  EXPECT_THAT(asked(3.3), ElementsAre(1, 2)) << "whoever knows the ids has not compared them";
  reader_.note_known(numbered(2));
  reader_.note_known(numbered(1));
  EXPECT_THAT(asked(9.0), ElementsAre(2, 2)) << "not all of it came in order";
  reader_.note_known(numbered(2));
  EXPECT_THAT(asked(99.0), IsEmpty());
  (void)reader_.note_start("w", 111, 99.0);
  EXPECT_THAT(asked(99.0), IsEmpty()) << "the same start";
  (void)reader_.note_start("w", 222, 99.0);
  EXPECT_THAT(asked(99.0), ElementsAre(1, 2));
  for (int forged = 0; forged < 1000; ++forged) (void)reader_.note_start("w", forged, 99.5);
  EXPECT_THAT(asked(99.5), IsEmpty()) << "a forger could have everything sent again and again";
}

TEST_F(StreamReaderTest, NoMoreThanHalfAWindowIsHandedOutBetweenTwoHeartbeats) {
  const std::uint64_t half = stream_window("test_window") / 2;
  StreamReader reader("reader", {});
  const auto window = [](std::uint64_t sequence) {
    TestWindow message;
    message.header.writer_id = "w";
    message.header.stream_sequence = sequence;
    return Message(message);
  };
  EXPECT_EQ(reader.accept(window(1)).size(), 1U);
  EXPECT_TRUE(reader.note_start("w", 111, 0.0).empty());
  reader.note_known(window(1));
  EXPECT_TRUE(reader.note_start("w", 111, 0.0).empty());
  std::size_t handed_out = 0;
  for (std::uint64_t k = 2; k <= 2 * half; ++k) handed_out += reader.accept(window(k)).size();
  EXPECT_EQ(handed_out, half);
  EXPECT_TRUE(reader.requests(100.0).empty()) << "nothing is missing";
  EXPECT_TRUE(reader.requests(200.0).empty());
  EXPECT_EQ(reader.note_start("w", 111, 0.0).size(), half - 1);
}

Message window_of_start(std::uint64_t sequence, std::int64_t writer_started_ns) {
  TestWindow message;
  message.header.writer_id = "w";
  message.header.stream_sequence = sequence;
  message.header.writer_started_ns = writer_started_ns;
  return message;
}

TEST_F(StreamReaderTest, MessagesThatSayWhenTheirWriterStartedWaitForNoHeartbeat) {
  const std::uint64_t window = stream_window("test_window");
  StreamReader reader("reader", {});
  std::size_t handed_out = 0;
  for (std::uint64_t k = 1; k <= 10 * window; ++k) {
    handed_out += reader.accept(window_of_start(k, 111)).size();
    if (k == 1) (void)reader.note_start("w", 111, 0.0);
  }
  EXPECT_EQ(handed_out, 10 * window);
}

TEST_F(StreamReaderTest, OfANewStartNothingIsHandedOutUntilWhatWasReadBeforeIsCompared) {
  StreamReader reader("reader", {});
  EXPECT_EQ(reader.accept(window_of_start(1, 111)).size(), 1U);
  EXPECT_EQ(reader.accept(window_of_start(2, 111)).size(), 1U);
  EXPECT_TRUE(reader.requests(100.0).empty());
  EXPECT_TRUE(reader.accept(window_of_start(3, 222)).empty()) << "the message itself says that its writer started anew";
  EXPECT_EQ(reader.accept(window_of_start(3, 111)).size(), 1U) << "it was on its way";
  EXPECT_TRUE(reader.accept(window_of_start(4, 222)).empty());
  const auto asked = reader.requests(101.1);
  ASSERT_EQ(asked.size(), 1U);
  EXPECT_EQ(asked[0].first_sequence, 1U);
  EXPECT_EQ(asked[0].last_sequence, 3U);
  EXPECT_TRUE(reader.note_start("w", 222, 102.0).empty()) << "a heartbeat proves nothing of what was read before";
  std::size_t handed_out = 0;
  for (const std::uint64_t k : {1, 2, 3}) {
    reader.note_known(window_of_start(k, 222));
    EXPECT_EQ(handed_out, 0U);
    handed_out += reader.accept(window_of_start(k, 222)).size();
  }
  EXPECT_EQ(handed_out, 1U) << "what waited for the comparison";
}

TEST_F(StreamReaderTest, AForgedHeartbeatHoldsUpNoMessageOfTheWriterItself) {
  StreamReader reader("reader", {});
  for (std::uint64_t k = 1; k <= 100; ++k) {
    EXPECT_EQ(reader.accept(window_of_start(k, 111)).size(), 1U);
    (void)reader.note_start("w", 1000 + static_cast<std::int64_t>(k), 0.01 * static_cast<double>(k));
  }
  EXPECT_LE(reader.requests(1.0).size(), 1U);
}

TEST_F(StreamReaderTest, OnlyTheAssetsThatAStreamIsAboutWaitForIt) {
  const auto block = [](std::uint64_t sequence, const std::string& asset_id) {
    RawSamples message;
    message.asset_id = asset_id;
    message.header.writer_id = "sender";
    message.header.stream_sequence = sequence;
    return Message(message);
  };
  EXPECT_EQ(reader_.accept(block(1, "A")).size(), 1U);
  EXPECT_TRUE(reader_.accept(block(3, "A")).empty());
  EXPECT_TRUE(reader_.is_behind("A"));
  EXPECT_FALSE(reader_.is_behind("B")) << "what a sender lost about another actuator";
  note(9, 0.0);
  EXPECT_TRUE(reader_.is_behind("B")) << "services write about all";
}

TEST_F(StreamReaderTest, WritersThatNothingWasReadOfAreWaitedForAMinuteAllTogether) {
  const auto stranger = [](int k) { return StreamPosition{"advisory", "stranger " + std::to_string(k), 7}; };
  double now_s = 0.0;
  for (int k = 0; now_s < 70.0; now_s += 0.5) {
    if (std::fmod(now_s, 30.0) == 0.0) reader_.note_written(stranger(++k), now_s);  // before the last one is given up
    EXPECT_EQ(reader_.is_behind("A"), now_s <= 60.0) << now_s;
    (void)reader_.requests(now_s);
  }
  EXPECT_EQ(sequences(reader_.accept(numbered(1, "stranger 1"))).size(), 1U);
  reader_.note_written(stranger(99), now_s);
  (void)reader_.requests(now_s);
  EXPECT_TRUE(reader_.is_behind("A")) << "one of them was real";
}

TEST_F(StreamReaderTest, AForgedWordThatComesAndGoesIsWaitedForNoLongerThanOneThatStays) {
  for (double now_s = 0.0; now_s < 200.0; now_s += 0.5) {
    note(std::fmod(now_s, 5.0) == 0.0 ? 2 : kHighest, now_s);  // the writer itself says 2
    (void)reader_.requests(now_s);
  }
  note(kHighest, 200.0);
  EXPECT_FALSE(reader_.is_behind("A"));
}

TEST_F(StreamReaderTest, AWriterThatCountsAnewIsReadFromItsStartButNotForEver) {
  EXPECT_TRUE(reader_.read_again({"advisory", "w"}, 0.0));
  EXPECT_THAT(accept(1), ElementsAre(1));
  EXPECT_THAT(accept(2), ElementsAre(2));
  EXPECT_FALSE(reader_.read_again({"advisory", "w"}, 30.0)) << "a forger could keep the reader busy";
  EXPECT_TRUE(reader_.read_again({"advisory", "w"}, 61.0));
  EXPECT_FALSE(reader_.read_again({"advisory", "nobody"}, 0.0));
}

using Range = ResendQueue::Range;
using For = ResendQueue::For;

constexpr std::uint64_t kSent = 1'000'000;

/// Whoever waits.
std::optional<Range> take(ResendQueue& queue, std::uint64_t most) {
  const auto for_readers = queue.take(For::readers, most);
  return for_readers ? for_readers : queue.take(For::strangers, most);
}

TEST(ResendQueueTest, ServesBoundedPieces) {
  ResendQueue queue;
  queue.add({Topic::advisory, 1, 150}, kSent);
  EXPECT_EQ(take(queue, 64), (Range{Topic::advisory, 1, 64}));
  EXPECT_EQ(take(queue, 64), (Range{Topic::advisory, 65, 128}));
  EXPECT_EQ(take(queue, 64), (Range{Topic::advisory, 129, 150}));
  EXPECT_EQ(take(queue, 64), std::nullopt);
}

TEST(ResendQueueTest, ServesSeveralReadersThatMissTheSameOnce) {
  ResendQueue queue;
  EXPECT_TRUE(queue.add({Topic::advisory, 1, 10}, kSent, "one"));
  EXPECT_TRUE(queue.add({Topic::advisory, 5, 20}, kSent, "another"));
  EXPECT_TRUE(queue.add({Topic::advisory, 21, 22}, kSent, "one"));
  EXPECT_TRUE(queue.add({Topic::state_report, 5, 6}, kSent, "one"));
  EXPECT_EQ(take(queue, 64), (Range{Topic::advisory, 1, 22}));
  EXPECT_EQ(take(queue, 64), (Range{Topic::state_report, 5, 6}));
  EXPECT_TRUE(queue.empty());
}

TEST(ResendQueueTest, WhoAsksForTheSameAllTheTimeGetsItOnceInAWhile) {
  ResendQueue queue;
  int served = 0;
  for (int ms = 0; ms < 9000; ++ms) {
    queue.add({Topic::advisory, 1, kHighest}, kSent, "flood", ResendQueue::Time(std::chrono::milliseconds(ms)));
    served += take(queue, kHighest) ? 1 : 0;
  }
  EXPECT_EQ(served, 10);
  EXPECT_TRUE(queue.add({Topic::advisory, 1, 2}, kSent, "reader")) << "another one has not had it";
}

TEST(ResendQueueTest, WhoAsksForEverythingLeavesRoomForOthers) {
  ResendQueue queue;
  for (std::uint64_t k = 0; k < 1000; ++k) queue.add({Topic::advisory, 256 * k + 1, 256 * k + 256}, kSent, "flood");
  ASSERT_TRUE(queue.add({Topic::state_report, 1, 256}, kSent, "reader"));
  std::uint64_t before = 0;
  for (auto range = take(queue, 16); range && range->topic == Topic::advisory; range = take(queue, 16)) before += 16;
  EXPECT_LE(before, 32U) << "ranges take turns";
}

TEST(ResendQueueTest, TakesTopicsInTurn) {
  ResendQueue queue;
  queue.add({Topic::advisory, 1, 100}, kSent);
  queue.add({Topic::state_report, 1, 1}, kSent);
  EXPECT_EQ(take(queue, 64)->topic, Topic::advisory);
  EXPECT_EQ(take(queue, 64)->topic, Topic::state_report);
  EXPECT_EQ(take(queue, 64)->topic, Topic::advisory);
}

TEST(ResendQueueTest, ARequestOfAnyRangeCountsForAWindowAndNoMoreThanWasSent) {
  const std::uint64_t window = stream_window("advisory");
  const auto served = [](std::uint64_t first, std::uint64_t last, std::uint64_t sent) {
    ResendQueue queue;
    queue.add({Topic::advisory, first, last}, sent);
    return take(queue, kHighest);
  };
  EXPECT_EQ(served(0, kHighest, 3), (Range{Topic::advisory, 1, 3}));
  EXPECT_EQ(served(0, kHighest, kSent), (Range{Topic::advisory, 1, window}));
  EXPECT_EQ(served(kHighest, kHighest, kHighest), (Range{Topic::advisory, kHighest, kHighest}));
  EXPECT_EQ(served(0, kHighest, kHighest), (Range{Topic::advisory, 1, window}));
  EXPECT_EQ(served(kHighest, 0, kSent), std::nullopt);
  EXPECT_EQ(served(kHighest - 3, kHighest, kSent), std::nullopt) << "of what there is not";
  EXPECT_EQ(served(0, 0, kSent), std::nullopt);
}

TEST(ResendQueueTest, RequestsAtTheHighestNumberTouchWhatTheyTouch) {
  ResendQueue queue;
  queue.add({Topic::advisory, kHighest, kHighest}, kHighest);
  queue.add({Topic::advisory, 1, 2}, kHighest);
  EXPECT_EQ(take(queue, 64), (Range{Topic::advisory, kHighest, kHighest}));
  EXPECT_EQ(take(queue, 64), (Range{Topic::advisory, 1, 2}));
}

TEST(ResendQueueTest, AFloodOfRequestsWaitsBounded) {
  ResendQueue scattered;
  for (std::uint64_t k = 1; k <= 100'000; ++k) scattered.add({Topic::advisory, 3 * k, 3 * k}, kSent);
  std::uint64_t messages = 0;
  while (const auto range = take(scattered, 64)) messages += range->last - range->first + 1;
  EXPECT_LE(messages, ResendQueue::kMostWaiting);
  ResendQueue joined;  // each touches the one before: the whole journal would be one range
  for (std::uint64_t k = 0; k < 1000; ++k)
    joined.add({Topic::advisory, 256 * k + 1, 256 * k + 256}, kSent, "reader " + std::to_string(k % 8));
  for (messages = 0; const auto range = take(joined, 64);) messages += range->last - range->first + 1;
  EXPECT_LE(messages, ResendQueue::kMostWaiting);
  EXPECT_GE(messages, 1000U);
}

TEST(ResendQueueTest, RestsForAsLongAsItSentAndLongerBesideWhatIsLive) {
  using std::chrono::milliseconds;
  const ResendQueue::Time begin{};
  const auto rest_ms = [&](const std::string& by, For whom, bool beside_live) {
    ResendQueue queue;
    queue.add({Topic::advisory, 1, 2}, kSent, by);
    EXPECT_EQ(queue.next(begin), whom);
    queue.note_sent(whom, begin, begin + milliseconds(30), beside_live);
    int ms = 30;
    while (!queue.next(begin + milliseconds(ms))) ++ms;
    return ms - 30;
  };
  EXPECT_EQ(rest_ms("reader", For::readers, false), 30);
  EXPECT_EQ(rest_ms("reader", For::readers, true), 4 * 30);
  EXPECT_EQ(rest_ms("", For::strangers, false), 4 * 30);
  EXPECT_EQ(rest_ms("", For::strangers, true), 16 * 30);
}

/// What a stranger asks for beside a reader neither takes that reader's place in the queue nor its time.
TEST(ResendQueueTest, StrangersHoldUpNoReader) {
  using std::chrono::milliseconds;
  ResendQueue queue;
  const ResendQueue::Time begin{};
  ASSERT_TRUE(queue.add({Topic::advisory, 1, 100}, kSent));
  queue.note_sent(For::strangers, begin, begin + milliseconds(30), true);
  EXPECT_EQ(queue.next(begin + milliseconds(31)), std::nullopt);
  ASSERT_TRUE(queue.add({Topic::advisory, 50, 60}, kSent, "reader"));
  ASSERT_TRUE(queue.add({Topic::advisory, 101, 200}, kSent));
  EXPECT_EQ(queue.next(begin + milliseconds(31)), For::readers);
  EXPECT_EQ(queue.take(For::readers, 64), (Range{Topic::advisory, 50, 60}));
  EXPECT_EQ(queue.next(begin + milliseconds(31)), std::nullopt);
  EXPECT_EQ(queue.take(For::strangers, 64), (Range{Topic::advisory, 1, 64}));
}

TEST(ResendQueueTest, PassesOverWhatIsEmpty) {
  ResendQueue queue;
  queue.add({Topic::advisory, 5, 4}, kSent);
  EXPECT_TRUE(queue.empty());
}

}  // namespace
}  // namespace sealwatch
