// What only the DDS bus has: flow control, QoS from the configuration, Cyclone's settings, processes that die.
#include "services/common/transport/dds_bus.hpp"

#include <gmock/gmock.h>
#include <signal.h>  // kill, pthread_kill: POSIX
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <thread>

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

std::unique_ptr<DdsBus> open(const Configuration& configuration,
                             SlowReader slow_reader = SlowReader::stops_publishers) {
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

TEST(FlowControl, AStuckServiceMakesPublishFailInTimeAndLosesNothingOfWhatWasPublished) {
  auto subscriber = open(isolated_configuration(1));
  ASSERT_TRUE(subscriber->subscribe(kTestWindow));
  auto publisher = open(isolated_configuration(2));
  ASSERT_TRUE(publisher->wait_for_subscribers(Topic::test_window, 1, kPatience));
  constexpr std::uint64_t kFarMoreThanFits = 100'000;
  std::uint64_t published = 0;
  Status status;
  auto last_success = Clock::now();
  for (; status && published < kFarMoreThanFits; published += status ? 1 : 0) {
    last_success = Clock::now();
    auto window = numbered<TestWindow>(published + 1);
    std::get<TestWindow>(window).samples.time_s.assign(10'000, 0.0);
    status = publisher->publish(window);
  }
  ASSERT_FALSE(status) << "nothing holds the publisher back: the stuck reader eats memory";
  EXPECT_THAT(status.error().describe(), testing::HasSubstr("test_window"));
  EXPECT_LT(Clock::now() - last_success, seconds(10));
  const auto numbers = receive_numbers(*subscriber);
  ASSERT_GE(numbers.size(), published);
  for (std::uint64_t k = 0; k < published; ++k) EXPECT_EQ(numbers[k], k + 1);
  EXPECT_TRUE(publisher->publish(numbered<TestWindow>(published + 1))) << "it goes on once the reader does";
}

TEST(FlowControl, AStuckClientLosesTheOldestAndStopsNobody) {
  auto client = open(isolated_configuration(1), SlowReader::loses_oldest);
  ASSERT_TRUE(client->subscribe(kTestWindow));
  auto publisher = open(isolated_configuration(2));
  ASSERT_TRUE(publisher->wait_for_subscribers(Topic::test_window, 1, kPatience));
  constexpr std::uint64_t kCount = 3000;
  for (std::uint64_t k = 1; k <= kCount; ++k) ASSERT_TRUE(publisher->publish(numbered<TestWindow>(k)));
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

TEST(DeadReader, HoldsUpItsPublisherNoLongerThanItsLease) {
  auto publisher = open(isolated_configuration(2));
  const pid_t child = start_child();
  ASSERT_TRUE(publisher->wait_for_subscribers(Topic::test_window, 1, kPatience));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  auto window = numbered<TestWindow>(1);
  std::get<TestWindow>(window).samples.time_s.assign(10'000, 0.0);
  const auto start = Clock::now();
  constexpr int kFarMoreThanAPublisherKeeps = 200;  // 80 kB each; it keeps about 0.5 MB for a reader that is silent
  for (int k = 0; k < kFarMoreThanAPublisherKeeps; ++k) {
    const Status published = publisher->publish(window);
    ASSERT_TRUE(published) << published.error().describe();
  }
  EXPECT_LT(Clock::now() - start, seconds(4)) << "the lease is 2 s";
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
