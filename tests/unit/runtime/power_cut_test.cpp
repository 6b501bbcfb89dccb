// A service under power cuts: what it has confirmed to senders and to people, or told as written from samples outside
// any stream, is there when it starts again. (Services that read it keep its outputs, or ask for them again.)
#include "tests/unit/store/power_cut.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "sealwatch/message/replacement_id.hpp"
#include "services/common/runtime/confirmed_positions.hpp"
#include "tests/unit/runtime/harness.hpp"

namespace sealwatch::testing {
namespace {

constexpr int kRounds = 4;

/// Takes what people say as well, and needs nothing of it.
class ListeningLayer final : public CuttingLayer {
 public:
  [[nodiscard]] std::span<const Topic> inputs() const override { return kAll; }
  [[nodiscard]] Conclusion receive(const Message& input) override {
    if (std::holds_alternative<RawSamples>(input)) return CuttingLayer::receive(input);
    return {{}, {header_of(input).message_id}};
  }

 private:
  static constexpr std::array kAll = {Topic::raw_samples, Topic::maintenance_event};
};

constexpr UtcTime kReplaced{1'800'000'000'000'000'000};

std::string replacement_of_round(const std::string& round) {
  return replacement_id_of(round, "XT03-MV2", "seal_replaced", kReplaced);
}

Message replacement(int round) {
  MaintenanceEvent event;
  event.asset_id = "XT03-MV2";
  event.kind = "seal_replaced";
  event.reported_by = "J. Silva";
  event.header = header(replacement_of_round(std::to_string(round)), "");
  event.header.event_time_known = true;
  event.header.event_time_ns = kReplaced.nanoseconds;
  event.header.writer_id = "operator-" + std::to_string(round);
  event.header.stream_sequence = 1;
  return event;
}

/// A test in one block, of a sender that numbers nothing.
Message unnumbered(int round) {
  RawSamples block;
  block.asset_id = "XT04-MV2";
  block.recording_id = "unnumbered " + std::to_string(round);
  block.boundary = BlockBoundary::end;
  block.header.message_id = "raw_samples/" + block.recording_id;
  return block;
}

Message numbered(int round) {
  RawSamples block;
  block.asset_id = "XT03-MV2";
  block.recording_id = "numbered " + std::to_string(round);
  block.boundary = BlockBoundary::end;
  block.header.message_id = "raw_samples/" + block.recording_id;
  block.header.writer_id = "sender";
  block.header.stream_sequence = static_cast<std::uint64_t>(round) + 1;
  return block;
}

/// Who sends, and listens to what is confirmed: ids of inputs.
class Listener {
 public:
  Listener(std::shared_ptr<InMemoryNetwork> network, DiskRecording& disk) : bus_(std::move(network)), disk_(disk) {
    EXPECT_TRUE(bus_.subscribe_service_topics());
  }
  void send(const Message& message) { EXPECT_TRUE(bus_.publish(message)); }
  void listen() {
    for (const BusItem& item : bus_.receive(std::chrono::milliseconds(0), 1000)) {
      const auto* status = std::get_if<ServiceStatus>(&item);
      if (status == nullptr) continue;
      for (const StreamPosition& position : status->received) hear(position);
      // Of each round the features of the numbered test come first.
      for (const StreamPosition& written : status->written)
        if (written.topic == "test_features" && written.sequence % 2 == 0)
          note("raw_samples/unnumbered " + std::to_string(written.sequence / 2 - 1));
    }
  }
  [[nodiscard]] std::size_t confirmed() const { return confirmed_.size(); }

 private:
  void hear(const StreamPosition& position) {
    if (position.sequence == 0) return;
    if (position.writer_id == "sender")
      note("raw_samples/numbered " + std::to_string(position.sequence - 1));
    else if (position.writer_id.starts_with("operator-"))
      note(replacement_of_round(position.writer_id.substr(9)));
  }
  void note(const std::string& id) {
    if (confirmed_.insert(id).second) disk_.confirm(id);
  }
  InMemoryBus bus_;
  DiskRecording& disk_;
  std::set<std::string> confirmed_;
};

TEST(PowerCutOfAService, BetweenAnyTwoWritesLeavesWhatItConfirmed) {
  const Place place;
  DiskRecording disk(place.directory());
  auto network = std::make_shared<InMemoryNetwork>();
  Listener listener(network, disk);
  {
    Process process(
        network, [] { return std::make_unique<ListeningLayer>(); }, place.connection());
    process.start();
    for (int round = 0; round < kRounds; ++round) {
      for (const Message& message : {numbered(round), replacement(round), unnumbered(round)}) {
        const std::size_t expected = listener.confirmed() + 1;
        listener.send(message);
        const auto step = [&] {
          process.step();
          listener.listen();
        };
        ASSERT_TRUE(step_until([&] { return listener.confirmed() == expected; }, step));
      }
    }
    disk.stop();
  }
  const Place after;
  std::mt19937 random(20'311'205);
  for (std::size_t event = 0; event <= disk.events(); ++event)
    for (const auto unsynced : {DiskRecording::Unsynced::lost, DiskRecording::Unsynced::torn}) {
      disk.restore(event, unsynced, random, after.directory());
      auto journal = Journal::open(after.connection(), "data_acquisition");
      ASSERT_TRUE(journal.has_value()) << journal.error().describe();
      for (const std::string& id : disk.confirmed_before(event))
        ASSERT_TRUE(journal->has_input(id).value()) << id << " is gone after a cut before event " << event;
    }
}

TEST(ConfirmedPositions, AreThoseThatTheDiskHas) {
  bool disk_works = false;
  int asked = 0;
  ConfirmedPositions confirmed([&] { return ++asked, disk_works; }, false);
  const auto told = [&](std::uint64_t samples, std::uint64_t windows) {
    ServiceStatus status;
    status.received = {{"raw_samples", "sender", samples}, {"test_window", "data_manipulation", windows}};
    const bool said = confirmed.make_sure(status);
    EXPECT_EQ(said, disk_works || samples == 3);
    return std::pair{said ? status.received[0].sequence : 0, status.received[1].sequence};
  };
  {
    ServiceStatus status;
    status.received = {{"raw_samples", "sender", 3}};
    EXPECT_FALSE(confirmed.make_sure(status)) << "nothing is said of what is not on the disk";
  }
  disk_works = true;
  EXPECT_EQ(told(3, 8), std::pair(std::uint64_t{3}, std::uint64_t{8}));
  const int before = asked;
  EXPECT_EQ(told(3, 9).first, 3U);
  EXPECT_EQ(asked, before) << "nothing new to bring to the disk";
  disk_works = false;
  EXPECT_EQ(told(5, 9).first, 0U) << "not said";
}

}  // namespace
}  // namespace sealwatch::testing
