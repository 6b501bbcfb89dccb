// A stranger that invents assets takes no more than a bounded room, and nothing from the assets that are configured.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>

#include "tests/unit/runtime/harness.hpp"

namespace sealwatch::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr int kAssets = 100'000;
constexpr int kPiece = 1000;

RawSamples test_of(const std::string& asset_id, const std::string& recording_id, std::uint64_t sequence) {
  RawSamples block;
  block.asset_id = asset_id;
  block.recording_id = recording_id;
  block.boundary = BlockBoundary::end;
  block.header.writer_id = "sender";
  block.header.stream_sequence = sequence;
  block.header.message_id = "raw/" + recording_id;
  return block;
}

class UnknownAssets : public ::testing::Test {
 protected:
  UnknownAssets() { EXPECT_TRUE(bus_.subscribe_service_topics()); }
  std::unique_ptr<Process> process() {
    RunnerOptions options = fast_options();
    options.assets = {"configured"};
    return process(options);
  }
  std::unique_ptr<Process> process(const RunnerOptions& options) {
    auto made = std::make_unique<Process>(
        network_, [this] { return ++layers_, std::make_unique<CuttingLayer>(); }, place_.connection(), Fate(), options);
    made->start();
    return made;
  }
  void send(const std::string& asset_id, const std::string& writer_id) {
    RawSamples block = test_of(asset_id, asset_id, 1);
    block.header.writer_id = writer_id;
    ASSERT_TRUE(bus_.publish(Message(block)));
  }
  void send(const std::string& asset_id) {
    ++sent_;
    ASSERT_TRUE(bus_.publish(Message(test_of(asset_id, asset_id + "/" + std::to_string(sent_), sent_))));
  }
  void step(Process& process, int times) {
    for (int k = 0; k < times; ++k) process.step();
    for (const BusItem& item : bus_.receive(std::chrono::milliseconds(5), 100'000))
      if (const auto* status = std::get_if<ServiceStatus>(&item); status && status->service == "data_acquisition")
        last_ = *status;
  }
  /// Bytes in use, but for what the network itself keeps for late subscribers: the last message of every asset.
  /// Below zero where more was given back meanwhile than this takes.
  std::ptrdiff_t memory() {
    const auto before = static_cast<std::ptrdiff_t>(::mallinfo2().uordblks);
    auto alike = std::make_shared<InMemoryNetwork>();
    InMemoryBus sender(alike);
    for (std::uint64_t k = 1; k <= sent_; ++k) {
      const std::string asset_id = "invented-" + std::to_string(k);
      EXPECT_TRUE(sender.publish(Message(test_of(asset_id, asset_id + "/" + std::to_string(k), k))));
    }
    return before - (static_cast<std::ptrdiff_t>(::mallinfo2().uordblks) - before);
  }
  static std::size_t outputs_of(Process& process, const std::string& asset_id) {
    std::size_t count = 0;
    for (const Message& output : process.outputs()) count += asset_of(output) == asset_id ? 1 : 0;
    return count;
  }

  Place place_;
  std::shared_ptr<InMemoryNetwork> network_ = std::make_shared<InMemoryNetwork>();
  InMemoryBus bus_{network_};
  std::uint64_t sent_ = 0;
  int layers_ = 0;
  ServiceStatus last_;
};

TEST_F(UnknownAssets, AreTakenUpToABoundAndTheOthersRefusedWithOneAlarm) {
  const auto service = process();
  std::ptrdiff_t halfway = 0;
  for (int k = 0; k < kAssets; ++k) {
    send("invented-" + std::to_string(k));
    if (k % kPiece != 0) continue;
    send("configured");
    step(*service, kPiece / 64 + 2);
    if (k == kAssets / 2) halfway = memory();
  }
  step(*service, kPiece / 64 + 2);
  EXPECT_LT(memory(), halfway + 1'000'000) << "bytes in use";
  EXPECT_LT(layers_, 64 + 8);
  EXPECT_EQ(outputs_of(*service, "configured"), 2U * kAssets / kPiece) << "nothing of a configured one is missing";
  ASSERT_TRUE(step_until([&] { return !last_.received.empty() && last_.received[0].sequence == sent_; },
                         [&] { step(*service, 1); }))
      << "what is refused holds up no stream";
  ASSERT_THAT(last_.alarms, SizeIs(1));
  EXPECT_EQ(last_.alarms[0].kind, "unknown_asset");
  EXPECT_THAT(last_.alarms[0].text, HasSubstr("asset 'invented-64' is not configured, and 64 such assets"));
}

/// What is refused of each is passed over; how far it was read is kept of so many.
TEST_F(UnknownAssets, OfInventedWritersFillNoJournal) {
  constexpr std::size_t kMost = 100;
  RunnerOptions options = fast_options();
  options.assets = {"configured"};
  options.most_positions = kMost;
  const auto service = process(options);
  for (int k = 0; k < 500; ++k) send("invented-" + std::to_string(k), "writer-" + std::to_string(k));
  send("configured", "sender");
  ASSERT_TRUE(step_until([&] { return outputs_of(*service, "configured") > 0; }, [&] { step(*service, 1); }));
  const std::vector<StreamPosition> positions = service->journal().positions().value();
  EXPECT_LE(positions.size(), kMost + 1);
  EXPECT_TRUE(std::ranges::any_of(positions, [](const StreamPosition& one) { return one.writer_id == "sender"; }));
}

TEST_F(UnknownAssets, ThatWereTakenStayOverARestart) {
  {
    const auto service = process();
    for (int k = 0; k < 64; ++k) send("known-" + std::to_string(k));
    step(*service, 4);
  }
  const auto service = process();
  send("new");
  send("known-63");
  step(*service, 3);
  EXPECT_EQ(outputs_of(*service, "new"), 0U);
  EXPECT_EQ(outputs_of(*service, "known-63"), 4U);
}

}  // namespace
}  // namespace sealwatch::testing
