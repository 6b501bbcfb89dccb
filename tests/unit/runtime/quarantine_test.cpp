// Messages on which a layer fails, in every way in which it can, and what goes on beside them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <new>

#include "services/common/store/quarantine_desk.hpp"
#include "tests/unit/runtime/harness.hpp"

namespace sealwatch::testing {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

pid_t service = 0;  ///< the process that is none of a trial
/// Kills in a row by which a message that fails is long set aside.
constexpr int kStorm = 7;

/// test_features -> state_report, with the number of the test; what a test does to it stands in its recording_id.
class FragileLayer final : public Layer {
 public:
  [[nodiscard]] std::string_view name() const override { return "state_detection"; }
  [[nodiscard]] std::span<const Topic> inputs() const override { return kInputs; }
  [[nodiscard]] std::span<const Topic> outputs() const override { return kOutputs; }
  void restore(const Message& /*own*/) override { ++tests_; }
  [[nodiscard]] Conclusion receive(const Message& input) override { return receive_until(input, {}); }
  [[nodiscard]] Conclusion receive_until(const Message& input, const std::stop_token& stop) override {
    const auto& test = std::get<TestFeatures>(input);
    ++tests_;  // also of a test that fails: a layer that raised is in no state that may go on
    suffer(test.recording_id, stop);
    StateReport report;
    report.asset_id = test.asset_id;
    report.header = header("state_report/" + test.header.pst_id, test.header.pst_id);
    report.verdict_reasons = {"test " + std::to_string(tests_)};
    const Conclusion conclusion{{report}, {test.header.message_id}};
    if (!test.recording_id.starts_with("later ")) return conclusion;
    return {{}, {}, [conclusion, what = test.recording_id.substr(6)](const std::stop_token& later_stop) {
              suffer(what, later_stop);
              return conclusion;
            }};
  }

 private:
  static void suffer(const std::string& what, const std::stop_token& stop) {
    if (what == "waits")
      while (!stop.stop_requested()) std::this_thread::sleep_for(milliseconds(1));
    if (what == "computes")
      for (volatile bool on = true; on;) on = !stop.stop_requested();
    if (what == "raises") throw std::runtime_error("no such phase");
    if (what == "raises no exception") throw 7;
    if (what == "takes all memory") throw std::bad_alloc();
    if (what == "aborts") std::abort();
    if (what == "is killed") ::raise(SIGKILL);
    if (what == "never ends")
      for (volatile bool forever = true; forever;) continue;
    if (what.starts_with("once killed ") && !std::ifstream(what.substr(12))) {
      std::ofstream(what.substr(12)) << "killed";
      ::kill(::getpid(), SIGKILL);
    }
    if (what.starts_with("killed in the service ") && ::getpid() == service) {
      const std::string deaths = what.substr(22);
      if (std::ifstream(deaths, std::ios::ate).tellg() >= kStorm) return;
      std::ofstream(deaths, std::ios::app) << '.' << std::flush;
      ::kill(service, SIGKILL);
    }
    if (what.starts_with("well with ") && !std::ifstream(what.substr(10))) throw std::runtime_error("not yet");
  }
  static constexpr std::array kInputs = {Topic::test_features, Topic::test_window};
  static constexpr std::array kOutputs = {Topic::state_report};
  int tests_ = 0;
};

std::unique_ptr<Layer> fragile() { return std::make_unique<FragileLayer>(); }

Message features(const std::string& asset, const std::string& pst, const std::string& fate = {}) {
  TestFeatures message;
  message.asset_id = asset;
  message.header = header("test_features/" + pst, pst);
  message.recording_id = fate;
  return message;
}

/// Of processor time: on a busy machine what is well takes long by the clock, too.
RunnerOptions impatient(const std::string& try_record = {}) {
  RunnerOptions options = fast_options();
  options.batch_time = milliseconds(20);
  options.lanes.workers.deadline = milliseconds(100);
  options.lanes.workers.grace = milliseconds(2000);
  options.lanes.try_record = try_record;
  return options;
}

std::vector<std::string> tests_concluded(Process& process) {
  std::vector<std::string> found;
  for (const Message& output : process.outputs())
    found.push_back(header_of(output).pst_id + ": " + std::get<StateReport>(output).verdict_reasons.front());
  return found;
}

class QuarantineTest : public ::testing::TestWithParam<const char*> {
 protected:
  std::unique_ptr<Process> start(RunnerOptions options = impatient()) {
    auto process = std::make_unique<Process>(network_, fragile, place_.connection(), Fate(), std::move(options));
    process->start();
    return process;
  }
  void send(const Message& message) { EXPECT_TRUE(sender_.publish(message)); }
  [[nodiscard]] std::string marker() const { return (place_.directory() / "marker").string(); }

  Place place_;
  std::shared_ptr<InMemoryNetwork> network_ = std::make_shared<InMemoryNetwork>();
  InMemoryBus sender_{network_};
};

INSTANTIATE_TEST_SUITE_P(Fates, QuarantineTest,
                         ::testing::Values("raises", "raises no exception", "takes all memory", "waits", "computes",
                                           "later raises", "later waits", "later computes", "later takes all memory"),
                         [](const auto& fate) {
                           std::string name = fate.param;
                           std::ranges::replace(name, ' ', '_');
                           return name;
                         });

TEST_P(QuarantineTest, ATestThatFailsTwiceIsSetAsideAndAllElseGoesOn) {
  RunnerOptions options = impatient();
  if (std::string(GetParam()).ends_with("waits")) options.lanes.workers.by_clock = milliseconds(2000);
  auto process = start(options);
  send(features("A", "a1"));
  send(features("A", "a2", GetParam()));
  send(features("A", "a3"));
  send(features("B", "b1"));
  ASSERT_TRUE(step_until([&] { return process->outputs().size() == 3; }, [&] { process->step(); }));
  // As a layer concludes that never saw the test; what is left for later goes on beside what comes next.
  const auto of_third = std::string(GetParam()).starts_with("later") ? ::testing::StartsWith("a3: ")
                                                                     : ::testing::StartsWith("a3: test 2");
  EXPECT_THAT(tests_concluded(*process), ::testing::UnorderedElementsAre("a1: test 1", of_third, "b1: test 1"));
  ASSERT_TRUE(step_until([&] { return !process->journal().quarantine()->empty(); }, [&] { process->step(); }));
  const std::vector<SetAside> quarantine = process->journal().quarantine().value();
  ASSERT_THAT(quarantine, SizeIs(1));
  EXPECT_EQ(quarantine[0].message_id, "test_features/a2");
  EXPECT_EQ(quarantine[0].pst_id, "a2");
  EXPECT_THAT(quarantine[0].reason, ::testing::MatchesRegex(".*(phase|exception|memory|within).*"));
  EXPECT_EQ(process->journal().open_inputs(), 0U);
}

TEST_F(QuarantineTest, StandsInTheHeartbeatAlsoAfterARestart) {
  InMemoryBus listener(network_);
  ASSERT_TRUE(listener.subscribe_service_topics());
  const auto heard = [&] {
    std::vector<ServiceAlarm> alarms;
    for (const BusItem& item : listener.receive(milliseconds(1), 10'000))
      if (const auto* status = std::get_if<ServiceStatus>(&item); status && status->state == "running")
        alarms = status->alarms;
    return alarms;
  };
  for (int life = 0; life < 2; ++life) {
    auto process = start();
    if (life == 0) send(features("A", "a1", "raises"));
    std::vector<ServiceAlarm> alarms;
    ASSERT_TRUE(step_until([&] { return !(alarms = heard()).empty(); }, [&] { process->step(); })) << life;
    EXPECT_EQ(alarms[0].kind, "set_aside");
    EXPECT_EQ(alarms[0].asset_id, "A");
    EXPECT_EQ(alarms[0].subject, "test_features/a1");
    EXPECT_EQ(alarms[0].text, "no such phase");
  }
}

TEST_F(QuarantineTest, WhatComesLaterOfTheSameTestIsSetAsideWithIt) {
  auto process = start();
  send(features("A", "a1", "raises"));
  ASSERT_TRUE(step_until([&] { return !process->journal().quarantine()->empty(); }, [&] { process->step(); }));
  TestWindow window;
  window.asset_id = "A";
  window.header = header("test_window/a1", "a1");
  send(Message(window));
  for (int k = 0; k < 3; ++k) process->step();
  EXPECT_TRUE(process->journal().has_input("test_window/a1").value());
  EXPECT_EQ(process->journal().open_inputs(), 0U);
}

TEST_F(QuarantineTest, IsTriedAgainWhereSomebodyAsksForIt) {
  auto process = start();
  send(features("A", "a1", "well with " + marker()));
  send(features("A", "a2"));
  ASSERT_TRUE(step_until([&] { return !process->journal().quarantine()->empty() && process->outputs().size() == 1; },
                         [&] { process->step(); }));
  auto desk = QuarantineDesk::open(place_.connection(), "state_detection");
  ASSERT_TRUE(desk) << desk.error().describe();
  EXPECT_FALSE(desk->ask_again("test_features/a2", "J. Silva", UtcTime{1}).value()) << "it is not set aside";
  std::ofstream(marker()) << "mended";
  EXPECT_TRUE(desk->ask_again("test_features/a1", "J. Silva", UtcTime{77}).value());
  ASSERT_TRUE(step_until([&] { return process->outputs().size() == 2; }, [&] { process->step(); }));
  EXPECT_THAT(tests_concluded(*process), ElementsAre("a2: test 1", "a1: test 2"));
  EXPECT_THAT(process->journal().quarantine().value(), IsEmpty());
  const auto record = desk->list().value();
  ASSERT_THAT(record, SizeIs(1)) << "who had it tried again is kept";
  EXPECT_EQ(record[0].state, "released");
  EXPECT_EQ(record[0].asked_by, "J. Silva");
  EXPECT_EQ(record[0].asked_ns, 77);
  const auto acts = read_audit_trail(place_.connection(), "state_detection").value();
  ASSERT_THAT(acts, SizeIs(1)) << "and cannot be changed unseen";
  EXPECT_EQ(acts[0].act.kind, "quarantine_retry");
  EXPECT_EQ(acts[0].act.who, "J. Silva");
  EXPECT_EQ(acts[0].act.asset_id, "A");
  EXPECT_EQ(acts[0].act.subject, "test_features/a1");
}

TEST_F(QuarantineTest, AsksForNothingOfAJournalWithoutItsTableWhichIsTold) {
  { auto process = start(); }
  place_.execute("DROP TABLE quarantine");
  {
    auto desk = QuarantineDesk::open(place_.connection(), "state_detection");
    ASSERT_TRUE(desk) << desk.error().describe();
    EXPECT_THAT(desk->list().value(), IsEmpty());
    EXPECT_FALSE(desk->ask_again("x", "J. Silva", UtcTime{1}).value());
  }
  auto process = start();
  const auto told = process->journal().quarantine().value();
  ASSERT_THAT(told, SizeIs(1));
  EXPECT_THAT(told[0].reason, HasSubstr("removed from it, table quarantine"));
}

/// Lives of a service in processes of their own, as its supervisor starts them.
class DeathTest : public QuarantineTest {
 protected:
  /// How many lives it took until all is concluded or set aside; each is given the same messages, as neighbours do.
  int lives(const std::vector<Message>& messages, std::size_t outputs, std::size_t set_aside) {
    for (int life = 1; life < 9; ++life) {
      const pid_t process = ::fork();
      if (process == 0) ::_exit(live(messages, outputs, set_aside));
      int status = 0;
      ::waitpid(process, &status, 0);
      if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return life;
    }
    return -1;
  }
  int live(const std::vector<Message>& messages, std::size_t outputs, std::size_t set_aside) {
    service = ::getpid();
    auto network = std::make_shared<InMemoryNetwork>();
    Process process(network, fragile, place_.connection(), Fate(), impatient(tries()));
    process.start();
    InMemoryBus sender(network);
    for (const Message& message : messages) (void)sender.publish(message);
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (std::chrono::steady_clock::now() < deadline) {
      if (!process.try_step()) ::_exit(3);
      if (process.outputs().size() == outputs && process.journal().quarantine()->size() == set_aside &&
          process.journal().open_inputs() == 0)
        return 0;
    }
    return 4;
  }
  [[nodiscard]] std::string tries() const { return (place_.directory() / "tries").string(); }
  std::vector<SetAside> quarantine() {
    return Journal::open(place_.connection(), "state_detection")->quarantine().value();
  }
};

INSTANTIATE_TEST_SUITE_P(Fates, DeathTest,
                         ::testing::Values("aborts", "is killed", "never ends", "later aborts", "later never ends"),
                         [](const auto& fate) {
                           std::string name = fate.param;
                           std::ranges::replace(name, ' ', '_');
                           return name;
                         });

TEST_P(DeathTest, AMessageThatEndsTheServiceDoesSoOnce) {
  const std::vector<Message> messages = {features("A", "a1"), features("A", "a2", GetParam()), features("A", "a3"),
                                         features("B", "b1")};
  EXPECT_EQ(lives(messages, 3, 1), 2);
  EXPECT_EQ(quarantine().at(0).message_id, "test_features/a2");
  EXPECT_EQ(lives(messages, 3, 1), 1) << "it is remembered";
  for (const auto& entry : std::filesystem::directory_iterator(place_.directory()))
    std::filesystem::remove(entry.path());
  EXPECT_EQ(lives(messages, 3, 1), 2) << "the journal was lost, and is made again from the neighbours";
}

TEST_F(DeathTest, AKillFromOutsideIsNoFaultOfTheMessage) {
  const std::vector<Message> messages = {features("A", "a1", "once killed " + marker()), features("A", "a2")};
  EXPECT_EQ(lives(messages, 2, 0), 2);
}

/// On a starved machine under many kills, each life may end before the work on a test does.
TEST_F(DeathTest, AStormOfKillsFromOutsideIsNoFaultOfTheMessageEither) {
  const std::vector<Message> messages = {features("A", "a1", "killed in the service " + marker()), features("A", "a2")};
  EXPECT_EQ(lives(messages, 2, 0), kStorm + 1);
}

/// Is not done with the messages of asset "slow" before all of "quick" are concluded.
class UnequalLayer final : public Layer {
 public:
  explicit UnequalLayer(const std::atomic<bool>& released) : released_(released) {}
  [[nodiscard]] std::string_view name() const override { return "state_detection"; }
  [[nodiscard]] std::span<const Topic> inputs() const override { return kInputs; }
  [[nodiscard]] std::span<const Topic> outputs() const override { return kOutputs; }
  void restore(const Message& /*own*/) override {}
  [[nodiscard]] Conclusion receive(const Message& input) override {
    while (asset_of(input).starts_with("slow") && !released_) std::this_thread::sleep_for(milliseconds(1));
    StateReport report;
    report.asset_id = asset_of(input);
    report.header = header("state_report/" + header_of(input).pst_id, header_of(input).pst_id);
    return {{report}, {header_of(input).message_id}};
  }

 private:
  static constexpr std::array kInputs = {Topic::test_features};
  static constexpr std::array kOutputs = {Topic::state_report};
  const std::atomic<bool>& released_;
};

TEST_F(QuarantineTest, SlowAndFloodingAssetsDelayNoOther) {
  RunnerOptions options = fast_options();
  options.batch_time = milliseconds(20);
  std::atomic<bool> released = false;
  Process process(
      network_, [&] { return std::make_unique<UnequalLayer>(released); }, place_.connection(), Fate(), options);
  process.start();
  constexpr int kFlood = 20;
  for (int k = 0; k < kFlood; ++k)
    for (const char number : std::string("123456"))
      send(features(std::string("slow ") + number, std::string("s") + number + "/" + std::to_string(k)));
  for (int k = 0; k < 30; ++k) send(features("quick", "q" + std::to_string(k)));
  const auto concluded = [&](std::size_t count) {
    return step_until([&] { return process.outputs().size() == count; }, [&] { process.step(); });
  };
  const bool quick_ones = concluded(30);
  released = true;
  ASSERT_TRUE(quick_ones) << "behind the flood";
  ASSERT_TRUE(concluded(30 + 6 * kFlood));
  std::map<std::string, std::vector<std::size_t>> places;
  std::map<std::string, std::vector<std::string>> order;
  const std::vector<Message> outputs = process.outputs();
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    places[asset_of(outputs[k])].push_back(k);
    order[asset_of(outputs[k])].push_back(header_of(outputs[k]).pst_id);
  }
  EXPECT_EQ(places["quick"].back(), 29U);
  for (int k = 0; k < kFlood; ++k) EXPECT_EQ(order["slow 3"][static_cast<std::size_t>(k)], "s3/" + std::to_string(k));
}

}  // namespace
}  // namespace sealwatch::testing
