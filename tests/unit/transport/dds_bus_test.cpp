// What only the DDS bus has: flow control, QoS from the configuration, Cyclone's settings, processes that die.
#include "services/common/transport/dds_bus.hpp"

#include <gmock/gmock.h>
#include <signal.h>  // kill, pthread_kill: POSIX
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "sealwatch/port/patient_publish.hpp"
#include "tests/unit/transport/kits.hpp"

namespace sealwatch::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Clock = std::chrono::steady_clock;

constexpr std::array kAdvisory = {Topic::advisory};
constexpr std::array kTestWindow = {Topic::test_window};
constexpr milliseconds kPatience{20'000};
constexpr milliseconds kQuiet{200};

std::unique_ptr<DdsBus> open(const Configuration& configuration, SlowReader slow_reader = SlowReader::asks_again) {
  auto bus = open_dds_bus(configuration, slow_reader);
  EXPECT_TRUE(bus) << bus.error().describe();
  return bus ? std::move(*bus) : nullptr;
}

template <class T>
Message numbered(std::uint64_t number) {
  T message;
  message.asset_id = "a";
  message.header.stream_sequence = number;
  return message;
}

std::vector<std::uint64_t> receive_numbers(Bus& bus) {
  std::vector<std::uint64_t> numbers;
  for (auto items = bus.receive(kPatience); !items.empty(); items = bus.receive(kQuiet))
    for (const BusItem& item : items) numbers.push_back(header_of(std::get<Message>(item)).stream_sequence);
  return numbers;
}

// ---- flow control

Message numbered_window(std::uint64_t number, std::size_t rows = 10'000) {
  Message message = numbered<TestWindow>(number);
  header_of(message).writer_id = "w";
  std::get<TestWindow>(message).samples.time_s.assign(rows, 0.0);
  return message;
}

/// How long this thread was ready and had no processor, as Linux counts it; 0 where it does not.
double waited_for_a_processor_ms() {
  std::ifstream statistics("/proc/thread-self/schedstat");
  double run_ns = 0.0, waited_ns = 0.0;
  statistics >> run_ns >> waited_ns;
  return statistics ? 1e-6 * waited_ns : 0.0;
}

/// How long each publish took, in ms, without what other programs took of it; how many were not taken.
struct Publishing {
  std::vector<double> took_ms;
  std::size_t refused = 0;
  void publish(Bus& bus, const Message& message) {
    const double waited_before_ms = waited_for_a_processor_ms();
    const auto start = Clock::now();
    refused += bus.publish(message) ? 0U : 1U;
    const double whole_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    took_ms.push_back(whole_ms - (waited_for_a_processor_ms() - waited_before_ms));
  }
  /// Nineteen of twenty: the others may have waited for another thread that had no processor.
  [[nodiscard]] double nearly_all_below_ms() {
    std::ranges::sort(took_ms);
    return took_ms[took_ms.size() * 19 / 20];
  }
};

constexpr double kLongestPublish_ms = 20.0;

/// Publishes until the bus has taken `count` windows.
void publish_all(Publishing& publishing, Bus& bus, std::uint64_t count) {
  for (std::uint64_t k = 1; k <= count;) {
    const std::size_t refused = publishing.refused;
    publishing.publish(bus, numbered_window(k));
    if (publishing.refused == refused) ++k;
  }
}

TEST(FlowControl, AServiceThatTakesNothingHoldsNobodyBackAndKeepsTheFirst) {
  auto subscriber = open(isolated_configuration(1));
  ASSERT_TRUE(subscriber->subscribe(kTestWindow));
  auto publisher = open(isolated_configuration(2));
  ASSERT_TRUE(publisher->wait_for_subscribers(Topic::test_window, 1, kPatience));
  constexpr std::uint64_t kFarMoreThanFits = 500;
  Publishing publishing;
  publish_all(publishing, *publisher, kFarMoreThanFits);
  EXPECT_LT(publishing.nearly_all_below_ms(), kLongestPublish_ms);
  const auto numbers = receive_numbers(*subscriber);
  ASSERT_GE(numbers.size(), 16U);
  EXPECT_LT(numbers.size(), kFarMoreThanFits) << "nothing bounds what waits";
  for (std::uint64_t k = 0; k < 16; ++k) EXPECT_EQ(numbers[k], k + 1);
  // The last may still have been on their way when there was room again: there is a gap before them, never a disorder.
  EXPECT_TRUE(std::ranges::is_sorted(numbers));
  ASSERT_TRUE(publish_patiently(*publisher, numbered_window(kFarMoreThanFits + 1), kPatience));
  const auto later = receive_numbers(*subscriber);
  ASSERT_FALSE(later.empty());
  EXPECT_EQ(later.back(), kFarMoreThanFits + 1);
}

/// What stalled a chain: its reader full, a process was deaf to the acknowledgements that its own writer waited for.
TEST(FlowControl, AServiceWhoseInputsPileUpPublishesAllTheSame) {
  auto upstream = open(isolated_configuration(1));
  auto service = open(isolated_configuration(2));
  auto downstream = open(isolated_configuration(3));
  ASSERT_TRUE(service->subscribe(std::array{Topic::sample_block}));
  ASSERT_TRUE(downstream->subscribe(kTestWindow));
  ASSERT_TRUE(upstream->wait_for_subscribers(Topic::sample_block, 1, kPatience));
  ASSERT_TRUE(service->wait_for_subscribers(Topic::test_window, 1, kPatience));
  constexpr std::uint64_t kMoreThanFits = 1500;
  for (std::uint64_t k = 1; k <= kMoreThanFits; ++k) {
    Message block = numbered<SampleBlock>(k);
    header_of(block).writer_id = "upstream";
    ASSERT_TRUE(publish_patiently(*upstream, block, kPatience));
  }
  constexpr std::uint64_t kWindows = 40;
  Publishing publishing;
  std::vector<std::uint64_t> arrived;
  const auto start = Clock::now();
  for (std::uint64_t k = 1; k <= kWindows;) {
    const std::size_t refused = publishing.refused;
    publishing.publish(*service, numbered_window(k, 100'000));
    if (publishing.refused == refused) ++k;
    for (const BusItem& item : downstream->receive(milliseconds(0)))
      arrived.push_back(header_of(std::get<Message>(item)).stream_sequence);
    ASSERT_LT(Clock::now() - start, kPatience) << "deaf after " << k << " windows";
  }
  EXPECT_LT(publishing.nearly_all_below_ms(), kLongestPublish_ms);
  while (arrived.size() < kWindows && Clock::now() - start < 2 * kPatience)
    for (const BusItem& item : downstream->receive(kQuiet))
      arrived.push_back(header_of(std::get<Message>(item)).stream_sequence);
  ASSERT_EQ(arrived.size(), kWindows);
  EXPECT_TRUE(std::ranges::is_sorted(arrived));
}

TEST(FlowControl, WhatIsNotNumberedWaitsForAServiceInDds) {
  auto subscriber = open(isolated_configuration(1));
  ASSERT_TRUE(subscriber->subscribe(kTestWindow));
  auto publisher = open(isolated_configuration(2));
  ASSERT_TRUE(publisher->wait_for_subscribers(Topic::test_window, 1, kPatience));
  constexpr std::uint64_t kMoreThanIsHeld = 400;
  std::uint64_t published = 0;
  auto window = numbered_window(1);
  header_of(window).writer_id.clear();  // of no writer's stream: nobody could ask for it again
  for (int refused = 0; published < kMoreThanIsHeld && refused < 20;) {
    header_of(window).stream_sequence = published + 1;
    if (publisher->publish(window))
      ++published;
    else
      ++refused;
  }
  EXPECT_LT(published, kMoreThanIsHeld) << "nothing holds the publisher back: the stuck reader eats memory";
  const auto numbers = receive_numbers(*subscriber);
  ASSERT_GE(numbers.size(), published);
  for (std::uint64_t k = 0; k < published; ++k) EXPECT_EQ(numbers[k], k + 1);
}

TEST(FlowControl, AStuckClientLosesTheOldestAndStopsNobody) {
  auto client = open(isolated_configuration(1), SlowReader::loses_oldest);
  ASSERT_TRUE(client->subscribe(kTestWindow));
  auto publisher = open(isolated_configuration(2));
  ASSERT_TRUE(publisher->wait_for_subscribers(Topic::test_window, 1, kPatience));
  constexpr std::uint64_t kCount = 3000;
  for (std::uint64_t k = 1; k <= kCount; ++k)
    ASSERT_TRUE(publish_patiently(*publisher, numbered<TestWindow>(k), kPatience));
  const auto numbers = receive_numbers(*client);
  ASSERT_FALSE(numbers.empty());
  EXPECT_LT(numbers.size(), kCount);
  EXPECT_EQ(numbers.back(), kCount);
  EXPECT_TRUE(std::ranges::is_sorted(numbers));
}

// ---- a process that dies. The child is this program again, running only the test below in the parent's DDS network.

TEST(DeadReader, DISABLED_Child) {
  Configuration configuration = isolated_configuration(3);
  configuration.cyclonedds_uri = std::getenv("TEST_PARENT_SETTINGS");
  auto subscriber = open(configuration);
  ASSERT_TRUE(subscriber->subscribe(kTestWindow));
  alarm(60);  // should the parent fail to end it
  pause();
}

pid_t start_child() {
  setenv("TEST_PARENT_SETTINGS", isolated_settings().c_str(), 1);
  const pid_t child = fork();
  if (child == 0) {
    execl("/proc/self/exe", "child", "--gtest_filter=DeadReader.DISABLED_Child", "--gtest_also_run_disabled_tests",
          "--gtest_brief=1", nullptr);
    _exit(1);
  }
  return child;
}

// 80 kB each; it keeps about 0.5 MB for a reader that is silent
constexpr std::uint64_t kFarMoreThanAPublisherKeeps = 200;

TEST(DeadReader, HoldsUpItsPublishersTopicNoLongerThanItsLeaseAndItsThreadNeverForMoreThan20Ms) {
  auto publisher = open(isolated_configuration(2));
  const pid_t child = start_child();
  ASSERT_TRUE(publisher->wait_for_subscribers(Topic::test_window, 1, kPatience));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  const auto start = Clock::now();
  Publishing publishing;
  publish_all(publishing, *publisher, kFarMoreThanAPublisherKeeps);
  EXPECT_LT(Clock::now() - start, seconds(8)) << "the lease is 2 s";
  EXPECT_GT(publishing.refused, 10U);
  EXPECT_LT(publishing.nearly_all_below_ms(), kLongestPublish_ms);
}

TEST(DeadReader, OneThatStopsHoldsUpItsPublisherAsOneThatDies) {
  auto publisher = open(isolated_configuration(2));
  const pid_t child = start_child();
  ASSERT_TRUE(publisher->wait_for_subscribers(Topic::test_window, 1, kPatience));
  kill(child, SIGSTOP);
  Publishing publishing;
  publish_all(publishing, *publisher, kFarMoreThanAPublisherKeeps);
  EXPECT_GT(publishing.refused, 10U);
  EXPECT_LT(publishing.nearly_all_below_ms(), kLongestPublish_ms);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
}

// ---- configuration

TEST(Qos, AVolatileTopicGivesALateSubscriberNothing) {
  Configuration configuration = isolated_configuration(1);
  configuration.topics["advisory"].transient_local = false;
  auto publisher = open(configuration);
  ASSERT_TRUE(publisher->publish(numbered<Advisory>(1)));
  auto late = open(configuration);
  ASSERT_TRUE(late->subscribe(kAdvisory));
  EXPECT_TRUE(late->receive(kQuiet).empty());
}

/// As a control system with the durability that DDS gives by default: its samples would be missed by nobody.
TEST(Qos, AWriterThatOffersLessThanIsAskedForIsToldOf) {
  Configuration configuration = isolated_configuration(1);
  auto service = open(configuration);
  ASSERT_TRUE(service->subscribe(kAdvisory));
  auto heard = open(configuration);
  ASSERT_TRUE(heard->announce(kAdvisory));
  ASSERT_TRUE(heard->wait_for_subscribers(Topic::advisory, 1, kPatience));
  EXPECT_EQ(refused_by_dds(), std::nullopt);
  configuration.topics["advisory"].transient_local = false;
  auto unheard = open(configuration);
  ASSERT_TRUE(unheard->announce(kAdvisory));
  std::optional<std::string> refused;
  for (const auto end = Clock::now() + kPatience; !refused && Clock::now() < end; refused = refused_by_dds())
    std::this_thread::sleep_for(milliseconds(10));
  EXPECT_THAT(refused.value_or(""), testing::HasSubstr("sealwatch/advisory"));
  EXPECT_THAT(refused.value_or(""), testing::HasSubstr("durability"));
}

TEST(Qos, AStateTopicKeepsTheLastOfEveryAsset) {
  Configuration configuration = isolated_configuration(1);
  configuration.topics["advisory"].keep_all = false;
  auto publisher = open(configuration);
  auto subscriber = open(configuration);
  ASSERT_TRUE(subscriber->subscribe(kAdvisory));
  ASSERT_TRUE(publisher->wait_for_subscribers(Topic::advisory, 1, kPatience));
  for (std::uint64_t k = 1; k <= 50; ++k) ASSERT_TRUE(publisher->publish(numbered<Advisory>(k)));
  EXPECT_EQ(receive_numbers(*subscriber), std::vector<std::uint64_t>{50});
}

TEST(Qos, ALifespanEndsWhatALateSubscriberGets) {
  Configuration configuration = isolated_configuration(1);
  configuration.topics["advisory"].lifespan_s = 0.1;
  auto publisher = open(configuration);
  ASSERT_TRUE(publisher->publish(numbered<Advisory>(1)));
  std::this_thread::sleep_for(milliseconds(300));
  auto late = open(configuration);
  ASSERT_TRUE(late->subscribe(kAdvisory));
  EXPECT_TRUE(late->receive(kQuiet).empty());
}

TEST(Settings, AnErrorNamesTheDomainAndWhatToCheck) {
  Configuration configuration = isolated_configuration(5);
  configuration.cyclonedds_uri = "<CycloneDDS><Domain Id=\"any\"><NoSuchElement/></Domain></CycloneDDS>";
  const auto bus = open_dds_bus(configuration);
  ASSERT_FALSE(bus);
  EXPECT_THAT(bus.error().describe(),
              testing::AllOf(testing::HasSubstr("domain 5"), testing::HasSubstr("cyclonedds_uri")));
}

TEST(Settings, ComeFromTheEnvironmentWhereItHasThem) {
  auto publisher = open(isolated_configuration(1));
  ASSERT_TRUE(publisher->publish(numbered<Advisory>(1)));
  const Configuration configuration = isolated_configuration(2);
  setenv("CYCLONEDDS_URI",
         "<CycloneDDS><Domain Id=\"any\"><General><Interfaces><NetworkInterface name=\"lo\" multicast=\"true\"/>"
         "</Interfaces></General><Discovery><ExternalDomainId>0</ExternalDomainId><Tag>elsewhere</Tag></Discovery>"
         "</Domain></CycloneDDS>",
         1);
  auto elsewhere = open(configuration);
  unsetenv("CYCLONEDDS_URI");
  ASSERT_TRUE(elsewhere->subscribe(kAdvisory));
  auto here = open(isolated_configuration(3));
  ASSERT_TRUE(here->subscribe(kAdvisory));
  EXPECT_EQ(here->receive(kPatience).size(), 1U);
  EXPECT_TRUE(elsewhere->receive(kQuiet).empty());
}

TEST(Settings, ADomainMayBeLeftAndJoinedAgain) {
  for (int round = 0; round < 3; ++round) {
    auto publisher = open(isolated_configuration(1));
    ASSERT_TRUE(publisher->publish(numbered<Advisory>(1)));
    auto subscriber = open(isolated_configuration(1));
    ASSERT_TRUE(subscriber->subscribe(kAdvisory));
    EXPECT_EQ(subscriber->receive(kPatience).size(), 1U);
  }
}

TEST(WaitForSubscribers, SaysHowManyAreThereWhenTheyDoNotCome) {
  auto publisher = open(isolated_configuration(1));
  const Status missing = publisher->wait_for_subscribers(Topic::raw_samples, 1, milliseconds(50));
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().describe(),
              testing::AllOf(testing::HasSubstr("raw_samples"), testing::HasSubstr("0 sub")));
}

// ---- wake from a signal handler

Bus* signalled_bus = nullptr;

TEST(Wake, MayBeCalledFromASignalHandler) {
  auto bus = open(isolated_configuration(1));
  signalled_bus = bus.get();
  ::signal(SIGUSR1, [](int) { signalled_bus->wake(); });
  const pthread_t receiver = pthread_self();
  std::thread sender([receiver] {
    std::this_thread::sleep_for(milliseconds(50));
    pthread_kill(receiver, SIGUSR1);  // interrupts the very thread that waits
  });
  const auto start = Clock::now();
  EXPECT_TRUE(bus->receive(kPatience).empty());
  EXPECT_LT(Clock::now() - start, kPatience / 2);
  sender.join();
}

}  // namespace
}  // namespace sealwatch::test
