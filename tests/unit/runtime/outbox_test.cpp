// What the bus does not take waits, by topic, and is tried again; nothing else waits with it.
#include "services/common/runtime/outbox.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/common/runtime/stream_window.hpp"

namespace sealwatch {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

template <class Content>
Message numbered(std::uint64_t sequence) {
  Content content;
  content.header.stream_sequence = sequence;
  return content;
}

class OutboxTest : public ::testing::Test {
 protected:
  using Sent = std::vector<std::pair<Topic, std::uint64_t>>;
  /// What was published at `ms`, when the bus takes nothing of `stuck`.
  Sent send(int ms, std::optional<Topic> stuck = {}) {
    Sent sent;
    const Outbox::Time now = begin_ + milliseconds(ms);
    outbox_.send(now, [&](const Message& message) {
      const bool taken = topic_of(message) != stuck;
      tries_ += taken ? 0 : 1;
      outbox_.note(topic_of(message), taken, now);
      if (taken) sent.emplace_back(topic_of(message), header_of(message).stream_sequence);
      return taken;
    });
    return sent;
  }
  Outbox outbox_;
  int tries_ = 0;
  const Outbox::Time begin_{};
};

TEST_F(OutboxTest, ATopicThatIsNotTakenHoldsUpNoOtherAndKeepsItsOrder) {
  outbox_.add(numbered<Advisory>(1));
  outbox_.add(numbered<Advisory>(2));
  outbox_.add(numbered<StateReport>(1));
  EXPECT_THAT(send(0, Topic::advisory), ElementsAre(Pair(Topic::state_report, 1)));
  EXPECT_EQ(tries_, 1) << "what follows in the stream waits with it";
  EXPECT_EQ(outbox_.first(Topic::advisory), 1);
  EXPECT_EQ(outbox_.first(Topic::state_report), std::nullopt);
  EXPECT_THAT(send(1000), ElementsAre(Pair(Topic::advisory, 1), Pair(Topic::advisory, 2)));
  EXPECT_TRUE(outbox_.empty());
}

TEST_F(OutboxTest, TriesSoonFirstThenMoreAndMoreRarely) {
  outbox_.add(numbered<Advisory>(1));
  for (int ms = 0; ms < 30; ++ms) EXPECT_THAT(send(ms, Topic::advisory), IsEmpty());
  EXPECT_GE(tries_, 3);
  tries_ = 0;
  for (int ms = 30; ms < 10'030; ++ms) EXPECT_THAT(send(ms, Topic::advisory), IsEmpty());
  EXPECT_LE(tries_, 60) << "each try may wait for 10 ms";
  EXPECT_GE(tries_, 40);
  EXPECT_EQ(send(10'300).size(), 1U);
}

TEST_F(OutboxTest, KeepsNoMoreThanAWindowOfAStreamAndNeverWithAGap) {
  const std::uint64_t window = stream_window("test_window");
  for (std::uint64_t k = 1; k <= 3 * window; ++k) outbox_.add(numbered<TestWindow>(k));
  const Sent sent = send(0);
  ASSERT_EQ(sent.size(), window);
  EXPECT_EQ(sent.back().second, window) << "the newest are in the journal and asked for";
  outbox_.add(numbered<TestWindow>(3 * window + 1));
  EXPECT_EQ(send(1).size(), 1U);
}

}  // namespace
}  // namespace sealwatch
