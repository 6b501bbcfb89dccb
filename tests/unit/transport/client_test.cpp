// The libraries for other people's programs, subscriber and sender, against a bus that plays the services.
#include "sealwatch/client/subscriber.hpp"

#include <gmock/gmock.h>

#include <array>
#include <thread>

#include "sealwatch/client/sender.hpp"
#include "tests/unit/transport/kits.hpp"

namespace sealwatch::test {
namespace {

using client::Subscriber;
using std::chrono::milliseconds;
constexpr milliseconds kPatience{20'000};

/// Same network as the services' bus, reached over UDP.
client::Options options() { return {.domain = 2, .cyclonedds_uri = isolated_settings(), .name = "test"}; }

std::unique_ptr<DdsBus> services() {
  auto bus = open_dds_bus(isolated_configuration(1));
  EXPECT_TRUE(bus);
  return std::move(*bus);
}

Message advisory(const std::string& asset, std::uint64_t sequence) {
  Advisory message;
  message.asset_id = asset;
  message.header.writer_id = "w";
  message.header.stream_sequence = sequence;
  return message;
}

TEST(Subscriber, GetsTheLastStateOfEveryAssetThenWhatIsNewWithoutRepetitions) {
  auto bus = services();
  for (std::uint64_t k = 1; k <= 4; ++k) ASSERT_TRUE(bus->publish(advisory(k % 2 == 0 ? "even" : "odd", k)));
  Subscriber subscriber(options());
  std::vector<std::pair<std::string, std::uint64_t>> got;
  subscriber.on<Advisory>([&](const Advisory& message) {
    got.emplace_back(message.asset_id, message.header.stream_sequence);
    if (got.size() == 2) {  // both last states are here: now repetitions of old ones, then news
      for (const std::uint64_t k : {1, 3, 5, 4, 5}) ASSERT_TRUE(bus->publish(advisory(k % 2 == 0 ? "even" : "odd", k)));
      ASSERT_TRUE(bus->publish(advisory("end", 6)));
    }
    if (message.asset_id == "end") subscriber.stop();
  });
  ASSERT_TRUE(subscriber.run_for(kPatience));
  ASSERT_EQ(got.size(), 4U);
  EXPECT_THAT(std::vector(got.begin(), got.begin() + 2),
              testing::UnorderedElementsAre(std::pair("odd", 3), std::pair("even", 4)));
  EXPECT_THAT(got[2], testing::Eq(std::pair<std::string, std::uint64_t>("odd", 5)));
}

TEST(Subscriber, HandsOutUnnumberedMessagesFromOutsideEachTime) {
  auto bus = services();
  Subscriber subscriber(options());
  int count = 0;
  subscriber.on<Advisory>([&](const Advisory&) {
    if (++count == 3) subscriber.stop();
    ASSERT_TRUE(bus->publish(advisory("a", 0)));
  });
  ASSERT_TRUE(bus->publish(advisory("a", 0)));
  ASSERT_TRUE(subscriber.run_for(kPatience));
  EXPECT_EQ(count, 3);
}

TEST(Subscriber, StopsFromAnotherThread) {
  Subscriber subscriber(options());
  const auto start = std::chrono::steady_clock::now();
  std::thread stopper([&] {
    std::this_thread::sleep_for(milliseconds(50));
    subscriber.stop();
  });
  EXPECT_TRUE(subscriber.run_for(kPatience));
  EXPECT_LT(std::chrono::steady_clock::now() - start, kPatience / 2);
  stopper.join();
}

TEST(Subscriber, RunsNoLongerThanTold) {
  Subscriber subscriber(options());
  const auto start = std::chrono::steady_clock::now();
  EXPECT_TRUE(subscriber.run_for(milliseconds(30)));
  EXPECT_LT(std::chrono::steady_clock::now() - start, kPatience / 2);
}

TEST(Subscriber, AcknowledgesAnAdvisory) {
  auto bus = services();
  constexpr std::array kAcknowledgement = {Topic::acknowledgement};
  ASSERT_TRUE(bus->subscribe(kAcknowledgement));
  Advisory seen;
  seen.asset_id = "XT03-MV2";
  seen.advisory_id = "XT03-MV2/7";
  seen.revision = 3;
  seen.header.message_id = "advisory/pst-1";
  Subscriber subscriber(options());
  const Status sent = subscriber.acknowledge(seen, "J. Operator", "vessel is booked");
  ASSERT_TRUE(sent) << sent.error().describe();
  const auto items = bus->receive(kPatience);
  ASSERT_EQ(items.size(), 1U);
  const auto& got = std::get<Acknowledgement>(std::get<Message>(items.front()));
  EXPECT_EQ(got.asset_id, "XT03-MV2");
  EXPECT_EQ(got.advisory_id, "XT03-MV2/7");
  EXPECT_EQ(got.acknowledged_by, "J. Operator");
  EXPECT_EQ(got.remark, "vessel is booked");
  EXPECT_EQ(got.header.message_id, "acknowledgement/XT03-MV2/7/3");
  EXPECT_THAT(got.header.source_ids, testing::ElementsAre("advisory/pst-1"));
  EXPECT_TRUE(got.header.event_time_known);
}

TEST(Subscriber, SaysSoWhenNobodyHearsAnAcknowledgement) {
  Subscriber subscriber(options());
  const Status sent = subscriber.acknowledge({}, "J. Operator");
  ASSERT_FALSE(sent);
  EXPECT_THAT(sent.error().describe(), testing::HasSubstr("acknowledgement"));
}

/// What data_acquisition says of the stream, and asks for.
class PlayedAcquisition {
 public:
  PlayedAcquisition() {
    constexpr std::array kRaw = {Topic::raw_samples};
    EXPECT_TRUE(bus_->subscribe(kRaw));
  }
  void receive() {
    for (const BusItem& item : bus_->receive(milliseconds(20)))
      if (const auto* message = std::get_if<Message>(&item)) came_.push_back(header_of(*message));
  }
  void confirm(std::uint64_t sequence) {
    ServiceStatus status;
    status.service = "data_acquisition";
    status.received.push_back({"raw_samples", came_.back().writer_id, sequence});
    ASSERT_TRUE(bus_->publish(status));
  }
  void ask_from_the_start() {
    ASSERT_TRUE(bus_->publish(ResendRequest{came_.front().writer_id, "raw_samples", 1, 2, "data_acquisition"}));
  }
  [[nodiscard]] const std::vector<Header>& came() const { return came_; }

 private:
  std::unique_ptr<DdsBus> bus_ = services();
  std::vector<Header> came_;
};

RawSamples block(const std::string& id) {
  RawSamples samples;
  samples.asset_id = "A";
  samples.header.message_id = id;
  return samples;
}

/// After a restore data_acquisition lacks what it had confirmed, and what the sender has forgotten.
TEST(Sender, GoesOnUnderANewNameWhereItIsAskedForWhatWasConfirmed) {
  PlayedAcquisition acquisition;
  client::Sender sender({.domain = 2, .cyclonedds_uri = isolated_settings(), .name = "test"});
  const auto until = [&](const auto& is_so, const auto& act) {
    const auto end = std::chrono::steady_clock::now() + kPatience;
    while (!is_so() && std::chrono::steady_clock::now() < end) {
      ASSERT_TRUE(sender.run_for(milliseconds(20)));
      acquisition.receive();
      act();
    }
    ASSERT_TRUE(is_so());
  };
  for (const char* id : {"r/1", "r/2"}) ASSERT_TRUE(sender.add(block(id)));
  until([&] { return sender.unconfirmed() == 0; },
        [&] {
          if (acquisition.came().size() >= 2) acquisition.confirm(2);
        });
  const std::string first_name = acquisition.came().front().writer_id;
  ASSERT_TRUE(sender.add(block("r/3")));
  until([&] { return acquisition.came().back().writer_id != first_name; }, [&] { acquisition.ask_from_the_start(); });
  EXPECT_EQ(acquisition.came().back().stream_sequence, 1U);
  EXPECT_EQ(acquisition.came().back().message_id, "r/3");
  until([&] { return sender.unconfirmed() == 0; }, [&] { acquisition.confirm(1); });
}

}  // namespace
}  // namespace sealwatch::test
