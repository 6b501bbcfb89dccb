// Who sends much waits behind itself alone, and what a stranger sends too much of is dropped and told.
#include "services/common/transport/inbox.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <set>

namespace sealwatch::transport {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::SizeIs;

constexpr std::size_t kLimit = 512;
constexpr Inbox::Time kNow = Inbox::Time(std::chrono::hours(1));
constexpr auto kRaw = static_cast<std::size_t>(Topic::raw_samples);

std::unique_ptr<BusItem> block(const std::string& asset_id, std::uint64_t number, const std::string& writer_id = {}) {
  RawSamples raw;
  raw.asset_id = asset_id;
  raw.source_id = "sender of " + asset_id;
  raw.block_number = number;
  raw.header.writer_id = writer_id;
  raw.header.stream_sequence = writer_id.empty() ? 0 : number;
  return std::make_unique<BusItem>(Message(raw));
}

std::uint64_t number_of(const BusItem& item) { return std::get<RawSamples>(std::get<Message>(item)).block_number; }
std::string asset_of(const BusItem& item) { return sealwatch::asset_of(std::get<Message>(item)); }

class InboxTest : public ::testing::Test {
 protected:
  InboxTest() { inbox_.know({"A", "B"}, {"sender of CONFIGURED"}); }
  std::vector<BusItem> take(std::size_t most, milliseconds at = milliseconds(1000)) {
    return inbox_.take(most, Inbox::Time(at));
  }
  Inbox inbox_;
};

TEST_F(InboxTest, ABlockWaitsBehindNoFloodOfAnother) {
  for (std::uint64_t k = 1; k <= 1000; ++k) inbox_.put(1, block("A", k), kLimit, kNow);
  for (std::uint64_t k = 1; k <= 3; ++k) inbox_.put(2, block("B", k), kLimit, kNow);
  std::vector<std::uint64_t> numbers;
  for (const BusItem& item : take(8))
    if (asset_of(item) == "B") numbers.push_back(number_of(item));
  EXPECT_THAT(numbers, ElementsAre(1, 2, 3));
  std::uint64_t last = 0;
  while (!inbox_.empty())
    for (const BusItem& item : take(64)) {
      EXPECT_GT(number_of(item), last) << "each writer's in order";
      last = number_of(item);
    }
  EXPECT_EQ(last, 1000U);
}

TEST_F(InboxTest, OfNumberedMessagesWhoHasMoreThanItsShareWaitingIsLeftOut) {
  for (std::uint64_t k = 1; k <= 10 * kLimit; ++k) inbox_.put(1, block("A", k, "flood"), kLimit, kNow);
  for (std::uint64_t k = 1; k <= 100; ++k) inbox_.put(2, block("B", k, "live"), kLimit, kNow);
  std::size_t live = 0;
  std::size_t all = 0;
  while (!inbox_.empty())
    for (const BusItem& item : take(64)) {
      live += asset_of(item) == "B" ? 1 : 0;
      ++all;
    }
  EXPECT_EQ(live, 100U);
  EXPECT_EQ(all, kLimit + 100);
}

TEST_F(InboxTest, WhoSendsUnnumberedBlocksAloneWaitsAndLosesNone) {
  for (std::uint64_t k = 1; k <= 2 * kLimit + 100; ++k) inbox_.put(1, block("A", k), kLimit, kNow);
  EXPECT_TRUE(inbox_.is_full(kRaw, kLimit, kNow)) << "the rest stays in DDS";
  EXPECT_THAT(inbox_.floods(), SizeIs(0));
}

TEST_F(InboxTest, WhereOthersSendTooNobodyWaitsInDdsForAFloodOfAKnownSender) {
  inbox_.put(2, block("B", 1), kLimit, kNow);
  EXPECT_THAT(take(64), SizeIs(1));
  for (std::uint64_t k = 1; k <= 20 * kLimit; ++k) inbox_.put(1, block("A", k), kLimit, kNow);
  EXPECT_FALSE(inbox_.is_full(kRaw, kLimit, kNow));
  for (std::uint64_t k = 2; k <= 100; ++k) inbox_.put(2, block("B", k), kLimit, kNow);
  const auto floods = inbox_.floods();
  ASSERT_THAT(floods, SizeIs(1));
  EXPECT_EQ(floods[0].source, "sender of A");
  EXPECT_EQ(floods[0].dropped, 18 * kLimit);
  std::size_t live = 0;
  for (const BusItem& item : inbox_.take(2 * 99, kNow)) live += asset_of(item) == "B" ? 1 : 0;
  EXPECT_EQ(live, 99U) << "all that it sent, in its turns";
  const auto later = kNow + Inbox::kForgotten + std::chrono::seconds(1);
  for (std::uint64_t k = 1; k <= 2 * kLimit; ++k) inbox_.put(1, block("A", k), kLimit, later);
  EXPECT_TRUE(inbox_.is_full(kRaw, kLimit, later)) << "alone again";
}

TEST_F(InboxTest, ASenderThatStartsAgainIsStillAlone) {
  inbox_.put(1, block("A", 1), kLimit, kNow);
  EXPECT_THAT(inbox_.take(64, kNow), SizeIs(1));
  for (std::uint64_t k = 2; k <= 3 * kLimit; ++k) inbox_.put(2, block("A", k), kLimit, kNow);
  EXPECT_TRUE(inbox_.is_full(kRaw, kLimit, kNow)) << "the rest waits in DDS";
  EXPECT_THAT(inbox_.floods(), SizeIs(0));
}

TEST_F(InboxTest, AWriterWhoseFirstBlockWasDroppedIsHeardLater) {
  constexpr std::uint64_t kWriters = 2 * kLimit + 10;  // each has a share of less than one block
  inbox_.put(0, block("B", 1), kLimit, kNow);
  for (std::uint64_t writer = 1; writer <= kWriters; ++writer) inbox_.put(writer, block("A", 1), kLimit, kNow);
  EXPECT_THAT(inbox_.floods(), SizeIs(1));
  while (!inbox_.empty()) (void)inbox_.take(64, kNow);
  for (std::uint64_t writer = 1; writer <= kWriters; ++writer) {
    inbox_.put(writer, block("A", 2), kLimit, kNow);
    EXPECT_THAT(inbox_.take(64, kNow), SizeIs(1)) << writer;
  }
}

TEST_F(InboxTest, AGatewaysBlocksOfManyAssetsDoNotWaitForEachOther) {
  Inbox open;
  constexpr int kAssets = 50, kOfEach = 5;
  for (int asset = 0; asset < kAssets; ++asset)
    for (std::uint64_t k = 1; k <= kOfEach; ++k) open.put(1, block(std::to_string(asset), k), kLimit, kNow);
  int takes = 0;
  for (; !open.empty(); ++takes) (void)open.take(64, kNow);
  EXPECT_LE(takes, 4);
}

TEST_F(InboxTest, AFloodOfOneAssetDelaysNoOtherOfItsWriter) {
  for (std::uint64_t k = 1; k <= 1000; ++k) inbox_.put(1, block("A", k), kLimit, kNow);
  for (std::uint64_t k = 1; k <= 3; ++k) inbox_.put(1, block("B", k), kLimit, kNow);
  std::map<std::string, std::vector<std::uint64_t>> numbers;
  for (const BusItem& item : take(8)) numbers[asset_of(item)].push_back(number_of(item));
  EXPECT_THAT(numbers["A"], ElementsAre(1, 2, 3, 4, 5));
  EXPECT_THAT(numbers["B"], ElementsAre(1, 2, 3));
}

TEST_F(InboxTest, BeyondItsWritersShareAnAssetsFloodIsDroppedAndNoOthersBlocks) {
  inbox_.put(2, block("B", 1), kLimit, kNow);
  for (std::uint64_t k = 1; k <= 20 * kLimit; ++k) inbox_.put(1, block("A", k), kLimit, kNow);
  for (std::uint64_t k = 1; k <= 100; ++k) inbox_.put(1, block("B", 100 + k), kLimit, kNow);
  const auto floods = inbox_.floods();
  ASSERT_THAT(floods, SizeIs(1));
  EXPECT_EQ(floods[0].source, "sender of A");
  std::size_t others = 0;
  for (const BusItem& item : inbox_.take(256, kNow)) others += number_of(item) > 100 && asset_of(item) == "B" ? 1 : 0;
  EXPECT_EQ(others, 100U);
}

TEST_F(InboxTest, AGatewayHasTheShareOfAllItsAssets) {
  Inbox inbox;
  std::set<std::string> assets = {"A"};
  for (int asset = 0; asset < 10; ++asset) assets.insert(std::to_string(asset));
  inbox.know(assets, {});
  inbox.put(2, block("0", 1), kLimit, kNow);
  for (std::uint64_t k = 1; k <= 20 * kLimit; ++k) inbox.put(1, block("A", k), kLimit, kNow);
  for (std::uint64_t k = 2; k <= 80; ++k)
    for (int asset = 0; asset < 10; ++asset) inbox.put(2, block(std::to_string(asset), k), kLimit, kNow);
  const auto floods = inbox.floods();
  ASSERT_THAT(floods, SizeIs(1));
  EXPECT_EQ(floods[0].source, "sender of A");
  for (std::uint64_t k = 1; k <= 20 * kLimit; ++k) inbox.put(1, block("A", k), kLimit, kNow);
  (void)inbox.floods();
  inbox.put(3, block("9", 100), kLimit, kNow);
  EXPECT_THAT(inbox.floods(), SizeIs(0)) << "whoever has nothing waiting is taken";
}

TEST_F(InboxTest, AWriterThatInventsAssetsHasTwiceItsShareAtMost) {
  Inbox open;  // where nothing is configured nobody is a stranger
  open.put(2, block("B", 1), kLimit, kNow);
  for (std::uint64_t k = 1; k <= 20 * kLimit; ++k) open.put(1, block(std::to_string(k), 1), kLimit, kNow);
  std::size_t waited = 0;
  for (; !open.empty();) waited += open.take(64, kNow).size();
  EXPECT_LE(waited, 1 + 2 * 2 * kLimit);
}

std::set<std::string> fleet(int assets) {
  std::set<std::string> names = {"A", "B"};
  for (int asset = 0; asset < assets; ++asset) names.insert(std::to_string(asset));
  return names;
}

TEST_F(InboxTest, OfNumberedMessagesSendersShareHoweverManyAssetsAnotherHas) {
  Inbox inbox;
  inbox.know(fleet(50), {});
  for (int asset = 0; asset < 50; ++asset)
    for (std::uint64_t k = 1; k <= 12; ++k) inbox.put(1, block(std::to_string(asset), k), kLimit, kNow);
  constexpr std::size_t kNumbered = 200;
  for (std::uint64_t k = 1; k <= kNumbered; ++k) inbox.put(2, block("A", k, "gateway"), kLimit, kNow);
  std::size_t numbered = 0;
  while (!inbox.empty())
    for (const BusItem& item : inbox.take(64, kNow)) numbered += asset_of(item) == "A" ? 1 : 0;
  EXPECT_EQ(numbered, kNumbered) << "none is asked for again";
}

TEST_F(InboxTest, AConfiguredSenderThatInventsAssetsHasTheShareOfOne) {
  inbox_.put(2, block("B", 1), kLimit, kNow);
  for (std::uint64_t k = 1; k <= 20 * kLimit; ++k) {
    auto invented = block("run " + std::to_string(k), 1);
    std::get<RawSamples>(std::get<Message>(*invented)).source_id = "sender of CONFIGURED";
    inbox_.put(1, std::move(invented), kLimit, kNow);
  }
  ASSERT_THAT(inbox_.floods(), SizeIs(1));
  for (std::uint64_t k = 1; k <= 100; ++k) inbox_.put(3, block("A", k), kLimit, kNow);
  EXPECT_THAT(inbox_.floods(), SizeIs(0)) << "nothing of others is dropped for it";
}

TEST_F(InboxTest, OfAFleetLargerThanTheQueueEachAssetHasOneBlock) {
  Inbox inbox;
  inbox.know(fleet(3000), {});
  inbox.put(2, block("B", 1), kLimit, kNow);
  for (int asset = 0; asset < 3000; ++asset) inbox.put(1, block(std::to_string(asset), 1), kLimit, kNow);
  EXPECT_THAT(inbox.floods(), SizeIs(0));
}

TEST_F(InboxTest, SaysWhetherATakeThatGaveFewHasLeftMore) {
  for (std::uint64_t k = 1; k <= 100; ++k) inbox_.put(1, block("A", k), kLimit, kNow);
  inbox_.put(2, block("B", 1), kLimit, kNow);
  EXPECT_THAT(inbox_.take(64, kNow), SizeIs(33)) << "of A its share";
  EXPECT_TRUE(inbox_.has_more());
  while (inbox_.has_more()) (void)inbox_.take(64, kNow);
  EXPECT_TRUE(inbox_.empty());
  for (std::uint64_t k = 1; k <= 1000; ++k) inbox_.put(7, block("UNKNOWN", k), kLimit, kNow);
  (void)inbox_.take(64, kNow);
  EXPECT_TRUE(inbox_.strangers_wait());
  EXPECT_FALSE(inbox_.has_more()) << "what strangers may not send yet is no work";
}

TEST_F(InboxTest, AFloodOfOneAssetHasItsShareOfEachTake) {
  for (std::uint64_t k = 1; k <= 1000; ++k) inbox_.put(1, block("A", k), kLimit, kNow);
  EXPECT_THAT(inbox_.take(64, kNow), SizeIs(64)) << "alone it is taken as fast as it comes";
  inbox_.put(2, block("B", 1), kLimit, kNow);
  EXPECT_THAT(inbox_.take(64, kNow), SizeIs(33)) << "whoever sends it, that asset has a half, and who waits has one";
}

TEST_F(InboxTest, AStrangersFloodIsTakenSlowlyAndDroppedAndTold) {
  (void)take(1, milliseconds(0));
  for (std::uint64_t k = 1; k <= 5000; ++k) inbox_.put(7, block("UNKNOWN", k), kLimit, kNow);
  inbox_.put(1, block("A", 1), kLimit, kNow);
  EXPECT_FALSE(inbox_.is_full(kRaw, kLimit, kNow)) << "nobody waits for it in DDS";
  std::size_t strangers = 0;
  std::size_t known = 0;
  for (int ms = 1; ms <= 2000; ++ms)
    for (const BusItem& item : take(64, milliseconds(ms))) ++(asset_of(item) == "A" ? known : strangers);
  EXPECT_EQ(known, 1U);
  EXPECT_GE(strangers, 2 * Inbox::kStrangersASecond - 1);
  EXPECT_LE(strangers, 2 * Inbox::kStrangersASecond);
  const auto floods = inbox_.floods();
  ASSERT_THAT(floods, SizeIs(1));
  EXPECT_EQ(floods[0].source, "sender of UNKNOWN");
  EXPECT_EQ(floods[0].dropped, 5000 - Inbox::kMostOfStrangers);
  EXPECT_TRUE(inbox_.strangers_wait());
  EXPECT_THAT(inbox_.floods(), SizeIs(0)) << "told once";
}

TEST_F(InboxTest, AConfiguredSenderIsNoStrangerAndNobodyIsWhereNothingIsConfigured) {
  Inbox open;
  for (std::uint64_t k = 1; k <= 1000; ++k) {
    inbox_.put(7, block("CONFIGURED", k), kLimit, kNow);
    open.put(7, block("UNKNOWN", k), kLimit, kNow);
  }
  std::size_t came = 0;
  while (!inbox_.empty()) came += take(64).size();
  while (!open.empty()) came += open.take(64, Inbox::Time()).size();
  EXPECT_EQ(came, 2000U);
}

TEST_F(InboxTest, AStrangersHeartbeatsHideNoServicesOwn) {
  const auto beat = [](const std::string& writer_id, std::int64_t started_ns) {
    ServiceStatus status;
    status.service = "data_acquisition";
    status.writer_id = writer_id;
    status.started_ns = started_ns;
    return std::make_unique<BusItem>(status);
  };
  inbox_.put(1, beat("itself", 1), kLimit, kNow);
  for (int k = 0; k < 100'000; ++k) inbox_.put(2, beat("stranger " + std::to_string(k), k), kLimit, kNow);
  inbox_.put(1, beat("itself", 2), kLimit, kNow);
  const auto taken = take(64);
  ASSERT_THAT(taken, SizeIs(2)) << "the last word of each";
  EXPECT_EQ(std::get<ServiceStatus>(taken[0]).started_ns, 2);
}

}  // namespace
}  // namespace sealwatch::transport
