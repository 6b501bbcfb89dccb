// The contract of sealwatch/port/bus.hpp, held against every implementation of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <map>
#include <numeric>
#include <set>
#include <thread>

#include "sealwatch/port/patient_publish.hpp"
#include "tests/unit/transport/kits.hpp"

namespace sealwatch::test {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

/// Longest wait for something that must come; far above the few milliseconds it takes, so that a busy machine does not
/// fail.
constexpr milliseconds kPatience{20000};
/// Wait for something that must not come.
constexpr milliseconds kQuiet{150};

constexpr std::array kAdvisory = {Topic::advisory};
const std::array<std::string, 3> kAssets = {"a", "b", "c"};
constexpr std::array kRawSamples = {Topic::raw_samples};

/// A message of which only the asset matters.
template <class T>
T of_asset(const std::string& asset) {
  T message;
  message.asset_id = asset;
  return message;
}

Message advisory(const std::string& asset, std::uint64_t number, const std::string& writer = "w") {
  auto message = of_asset<Advisory>(asset);
  message.header.writer_id = writer;
  message.header.stream_sequence = number;
  return message;
}

std::uint64_t number_of(const BusItem& item) { return header_of(std::get<Message>(item)).stream_sequence; }

class BusContract : public testing::TestWithParam<KitMaker> {
 protected:
  [[nodiscard]] std::unique_ptr<Bus> open() {
    auto bus = kit_->open();
    EXPECT_TRUE(bus);
    return bus;
  }
  [[nodiscard]] std::unique_ptr<Bus> open_subscribed(std::span<const Topic> topics) {
    auto bus = open();
    EXPECT_TRUE(bus->subscribe(topics));
    return bus;
  }
  /// Publishes until the subscriber has it: from then on the two are connected.
  static void connect(Bus& publisher, Bus& subscriber) {
    const auto deadline = Clock::now() + kPatience;
    bool arrived = false;
    while (!arrived && Clock::now() < deadline) {
      ASSERT_TRUE(publisher.publish(advisory("connect", 0)));
      arrived = !subscriber.receive(milliseconds(100)).empty();
    }
    ASSERT_TRUE(arrived);
    while (!subscriber.receive(kQuiet).empty()) {
    }
  }
  /// Receives until `count` items are there or patience is over.
  static std::vector<BusItem> collect(Bus& bus, std::size_t count) {
    std::vector<BusItem> all;
    const auto deadline = Clock::now() + kPatience;
    while (all.size() < count && Clock::now() < deadline)
      for (BusItem& item : bus.receive(milliseconds(100))) all.push_back(std::move(item));
    return all;
  }
  static std::vector<std::uint64_t> numbers(const std::vector<BusItem>& items) {
    std::vector<std::uint64_t> result;
    for (const BusItem& item : items) result.push_back(number_of(item));
    return result;
  }
  static std::vector<std::uint64_t> count_from_1(std::size_t count) {
    std::vector<std::uint64_t> result(count);
    std::iota(result.begin(), result.end(), 1U);
    return result;
  }

  std::unique_ptr<Kit> kit_ = GetParam()();
};

INSTANTIATE_TEST_SUITE_P(, BusContract, testing::Values(in_memory_kit, same_domain_kit, network_kit),
                         [](const auto& kit) {
                           return kit.param == in_memory_kit     ? "InMemory"
                                  : kit.param == same_domain_kit ? "SameDomain"
                                                                 : "Network";
                         });

TEST_P(BusContract, LosesNothingOfABurstAndKeepsItsOrder) {
  auto subscriber = open_subscribed(kAdvisory);
  auto publisher = open();
  connect(*publisher, *subscriber);
  constexpr std::size_t kBurst = 10'000;
  std::thread burst([&] {
    for (std::size_t k = 1; k <= kBurst; ++k)
      ASSERT_TRUE(publish_patiently(*publisher, advisory(kAssets[k % kAssets.size()], k, "")));
  });
  const auto items = collect(*subscriber, kBurst);
  burst.join();
  EXPECT_EQ(numbers(items), count_from_1(kBurst));
}

TEST_P(BusContract, CarriesLargeBlocksUnchanged) {
  auto subscriber = open_subscribed(kRawSamples);
  auto publisher = open();
  auto block = of_asset<RawSamples>("XT03-MV2");
  block.samples.time_s.resize(6200);
  std::iota(block.samples.time_s.begin(), block.samples.time_s.end(), 0.0);
  for (int channel = 0; channel < 11; ++channel)
    block.samples.channels.push_back({"channel", "Pa", 0.5, std::vector<double>(6200, channel + 0.1)});
  constexpr std::size_t kBlocks = 20;
  std::thread sender([&] {
    for (std::size_t k = 1; k <= kBlocks; ++k) {
      block.header.stream_sequence = k;
      ASSERT_TRUE(publish_patiently(*publisher, Message(block)));
    }
  });
  const auto items = collect(*subscriber, 1);
  sender.join();
  ASSERT_FALSE(items.empty());
  EXPECT_EQ(std::get<RawSamples>(std::get<Message>(items.front())).samples, block.samples);
}

TEST_P(BusContract, GivesALateSubscriberTheLastMessageOfEveryAssetOfEveryPublisher) {
  auto first = open();
  auto second = open();
  for (std::uint64_t k = 1; k <= 5; ++k) {
    ASSERT_TRUE(first->publish(advisory("a", k, "first")));
    ASSERT_TRUE(first->publish(advisory("b", 10 + k, "first")));
    ASSERT_TRUE(second->publish(advisory("a", 20 + k, "second")));
  }
  auto late = open_subscribed(kAdvisory);
  auto got = numbers(collect(*late, 3));
  std::ranges::sort(got);
  EXPECT_EQ(got, (std::vector<std::uint64_t>{5, 15, 25}));
  EXPECT_TRUE(late->receive(kQuiet).empty());
}

TEST_P(BusContract, GivesALateSubscriberBothAssetsOfEveryTopicOfConclusions) {
  const std::vector<Topic> topics = {Topic::test_features,    Topic::state_report,     Topic::health_report,
                                     Topic::leakage_estimate, Topic::remaining_life,   Topic::pst_request,
                                     Topic::advisory,         Topic::model_discrepancy};
  auto publisher = open();
  const auto publish = [&]<class Report>(Report) {
    for (const char* asset : {"a", "b"}) {
      Report report = of_asset<Report>(asset);
      report.header.stream_sequence = asset == std::string("a") ? 1 : 2;
      ASSERT_TRUE(publisher->publish(Message(report)));
    }
  };
  publish(TestFeatures{}), publish(StateReport{}), publish(HealthReport{}), publish(LeakageEstimate{});
  publish(RemainingLife{}), publish(PstRequest{}), publish(Advisory{}), publish(ModelDiscrepancy{});
  auto late = open_subscribed(topics);
  std::map<Topic, std::set<std::string>> assets;
  for (const BusItem& item : collect(*late, 2 * topics.size())) {
    const Message& message = std::get<Message>(item);
    assets[topic_of(message)].insert(asset_of(message));
  }
  for (const Topic topic : topics) EXPECT_EQ(assets[topic], (std::set<std::string>{"a", "b"})) << name_of(topic);
}

TEST_P(BusContract, KeepsTheOrderOfEachOfTwoPublishers) {
  auto subscriber = open_subscribed(kAdvisory);
  auto first = open();
  auto second = open();
  connect(*first, *subscriber);
  connect(*second, *subscriber);
  constexpr std::size_t kEach = 500;
  const auto send = [](Bus& bus, const std::string& writer) {
    for (std::uint64_t k = 1; k <= kEach; ++k) ASSERT_TRUE(publish_patiently(bus, advisory("a", k, writer)));
  };
  std::thread sender([&] { send(*first, "first"); });
  send(*second, "second");
  const auto items = collect(*subscriber, 2 * kEach);
  sender.join();
  std::map<std::string, std::vector<std::uint64_t>> by_writer;
  for (const BusItem& item : items) by_writer[header_of(std::get<Message>(item)).writer_id].push_back(number_of(item));
  EXPECT_EQ(by_writer["first"], count_from_1(kEach));
  EXPECT_EQ(by_writer["second"], count_from_1(kEach));
}

TEST_P(BusContract, DeliversWhatWasPublishedJustBeforeThePublisherClosed) {
  auto subscriber = open_subscribed(kAdvisory);
  auto publisher = open();
  connect(*publisher, *subscriber);
  constexpr std::size_t kCount = 300;
  for (std::uint64_t k = 1; k <= kCount; ++k) ASSERT_TRUE(publish_patiently(*publisher, advisory("a", k)));
  publisher.reset();
  EXPECT_EQ(numbers(collect(*subscriber, kCount)), count_from_1(kCount));
  EXPECT_TRUE(subscriber->receive(kQuiet).empty()) << "the end of a publisher is not a message";
}

TEST_P(BusContract, HearsARestartedPublisher) {
  auto subscriber = open_subscribed(kAdvisory);
  for (std::uint64_t life = 1; life <= 3; ++life) {
    auto publisher = open();
    ASSERT_TRUE(publisher->publish(advisory("a", life)));
    EXPECT_EQ(numbers(collect(*subscriber, 1)), std::vector<std::uint64_t>{life});
  }
}

TEST_P(BusContract, GivesOnlySubscribedTopics) {
  auto subscriber = open_subscribed(kAdvisory);
  auto publisher = open();
  connect(*publisher, *subscriber);
  ASSERT_TRUE(publisher->publish(Message(of_asset<PstRequest>("a"))));
  ASSERT_TRUE(publisher->publish(ServiceStatus{}));
  ASSERT_TRUE(publisher->publish(advisory("a", 1)));
  EXPECT_EQ(numbers(collect(*subscriber, 1)), std::vector<std::uint64_t>{1});
  EXPECT_TRUE(subscriber->receive(kQuiet).empty());
}

TEST_P(BusContract, CarriesServiceTopics) {
  auto subscriber = open();
  ASSERT_TRUE(subscriber->subscribe_service_topics());
  auto publisher = open();
  ServiceStatus status;
  status.service = "state_detection";
  status.written = {{"state_report", "w", 7}};
  ASSERT_TRUE(publisher->publish(status));
  auto items = collect(*subscriber, 1);
  ASSERT_EQ(items.size(), 1U);
  EXPECT_EQ(std::get<ServiceStatus>(items.front()), status);
  const ResendRequest request{"w", "advisory", 3, 9, "state_detection"};
  const auto deadline = Clock::now() + kPatience;  // a request is for those who are there: repeated until it is heard
  for (items.clear(); items.empty() && Clock::now() < deadline; items = subscriber->receive(milliseconds(100)))
    ASSERT_TRUE(publisher->publish(request));
  ASSERT_FALSE(items.empty());
  EXPECT_EQ(std::get<ResendRequest>(items.front()), request);
}

TEST_P(BusContract, TheFirstMessagesOfAnAnnouncedTopicReachWhoIsThere) {
  auto subscriber = open_subscribed(kAdvisory);
  ASSERT_TRUE(subscriber->subscribe_service_topics());
  auto publisher = open();
  ASSERT_TRUE(publisher->announce(kAdvisory));
  std::this_thread::sleep_for(milliseconds(1500));  // they find each other within a few tens of milliseconds
  ASSERT_TRUE(publisher->publish(ResendRequest{"w", "advisory", 3, 9, "state_detection"}));
  for (std::uint64_t k = 1; k <= 5; ++k) ASSERT_TRUE(publisher->publish(advisory("a", k)));
  EXPECT_EQ(collect(*subscriber, 6).size(), 6U);
}

TEST_P(BusContract, TakesAtMostAsManyAsAskedFor) {
  auto subscriber = open_subscribed(kAdvisory);
  auto publisher = open();
  connect(*publisher, *subscriber);
  for (std::uint64_t k = 1; k <= 100; ++k) ASSERT_TRUE(publisher->publish(advisory("a", k)));
  std::vector<std::uint64_t> got;
  const auto deadline = Clock::now() + kPatience;
  for (std::size_t most = 1; got.size() < 100 && Clock::now() < deadline; most = most % 10 + 3) {
    const auto taken = numbers(subscriber->receive(milliseconds(100), most));
    EXPECT_LE(taken.size(), most);
    got.insert(got.end(), taken.begin(), taken.end());
  }
  EXPECT_EQ(got, count_from_1(100));
}

TEST_P(BusContract, WakesAReceiveThatWaits) {
  auto bus = open_subscribed(kAdvisory);
  const auto start = Clock::now();
  std::thread waker([&] {
    std::this_thread::sleep_for(milliseconds(50));
    bus->wake();
  });
  EXPECT_TRUE(bus->receive(kPatience).empty());
  waker.join();
  EXPECT_LT(Clock::now() - start, kPatience / 2);
}

TEST_P(BusContract, RemembersAWakeThatCameBeforeTheReceive) {
  auto bus = open_subscribed(kAdvisory);
  bus->wake();
  const auto start = Clock::now();
  EXPECT_TRUE(bus->receive(kPatience).empty());
  EXPECT_LT(Clock::now() - start, kPatience / 2);
}

TEST_P(BusContract, WaitsNoLongerThanTold) {
  auto bus = open_subscribed(kAdvisory);
  const auto start = Clock::now();
  EXPECT_TRUE(bus->receive(milliseconds(60)).empty());
  EXPECT_GE(Clock::now() - start, milliseconds(60));
  EXPECT_LT(Clock::now() - start, kPatience / 2);
}

}  // namespace
}  // namespace sealwatch::test
