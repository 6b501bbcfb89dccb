// Samples that nobody needs any more are dropped, and no others; who gets what is left of them passes it on.
#include "services/common/runtime/retention.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/runtime/harness.hpp"

namespace sealwatch::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// raw_samples -> test_window at once; or, as a reader, test_window -> nothing, and says what it was given.
class WindowLayer final : public Layer {
 public:
  [[nodiscard]] std::string_view name() const override { return "data_manipulation"; }
  [[nodiscard]] std::span<const Topic> inputs() const override { return kInputs; }
  [[nodiscard]] std::span<const Topic> outputs() const override { return kOutputs; }
  void restore(const Message& own) override { (void)own; }
  [[nodiscard]] Conclusion receive(const Message& input) override {
    if (given && std::holds_alternative<TestWindow>(input)) given->push_back(header_of(input).message_id);
    const auto* block = std::get_if<RawSamples>(&input);
    if (block == nullptr) return {{}, {header_of(input).message_id}};
    TestWindow window;
    window.asset_id = block->asset_id;
    window.header = header("test_window/" + block->recording_id, block->recording_id);
    window.samples.time_s.assign(1000, 1.0);
    return {{window}, {block->header.message_id}};
  }
  std::vector<std::string>* given = nullptr;

 private:
  static constexpr std::array kInputs = {Topic::raw_samples, Topic::test_window};
  static constexpr std::array kOutputs = {Topic::test_window};
};

class RetentionTest : public ::testing::Test {
 protected:
  RetentionTest() {
    options_.retention.days = 30.0;
    options_.retention_pause = std::chrono::milliseconds(0);
  }
  std::unique_ptr<Process> start(std::vector<std::string>* given = nullptr) {
    const auto layer = [given] {
      auto made = std::make_unique<WindowLayer>();
      made->given = given;
      return made;
    };
    auto process = std::make_unique<Process>(network_, layer, place_.connection(), Fate(), options_);
    process->start();
    return process;
  }
  /// Windows of so many tests of one asset.
  void conclude(Process& process, int tests) {
    std::vector<RawSamples> blocks = blocks_of_tests(tests, {"A"});
    std::erase_if(blocks, [](const RawSamples& block) { return block.boundary != BlockBoundary::end; });
    Feeder feeder(network_, blocks);
    feeder.send(blocks.size());
    ASSERT_TRUE(step_until([&] { return process.outputs().size() == static_cast<std::size_t>(tests); },
                           [&] { process.step(); }));
  }
  void say_read(const std::string& service, const std::string& writer_id, std::uint64_t sequence,
                std::vector<ServiceAlarm> alarms = {}) {
    ServiceStatus status;
    status.service = status.writer_id = service;
    status.received = {{"test_window", writer_id, sequence}};
    status.alarms = std::move(alarms);
    ASSERT_TRUE(bus_.publish(status));
  }
  void say_all_read(const std::string& writer_id, std::uint64_t sequence, std::vector<ServiceAlarm> alarms = {}) {
    for (const char* reader : {"state_detection", "health_assessment", "prognostic_assessment"})
      say_read(reader, writer_id, sequence, alarms);
  }
  static std::vector<int> with_samples(Process& process) {
    std::vector<int> found;
    for (const Message& output : process.outputs())
      found.push_back(std::get<TestWindow>(output).samples.time_s.empty() ? 0 : 1);
    return found;
  }
  /// Looks twice.
  static void let_pass(Process& process) {
    for (int look = 0; look < 2; ++look) step_for(std::chrono::milliseconds(1100), [&] { process.step(); });
  }

  Place place_;
  std::shared_ptr<InMemoryNetwork> network_ = std::make_shared<InMemoryNetwork>();
  InMemoryBus bus_{network_};
  RunnerOptions options_ = fast_options();
};

TEST_F(RetentionTest, DropsOldSamplesThatAllReadersHaveButOfTheNewestTest) {
  const auto process = start();
  conclude(*process, 4);
  const std::string writer = process->journal().writer_id();
  say_all_read(writer, 4);
  let_pass(*process);
  EXPECT_THAT(with_samples(*process), ElementsAre(1, 1, 1, 1)) << "they are young";
  process->clock().set(add_seconds(process->clock().now(), 31 * kSecondsPerDay));
  let_pass(*process);
  EXPECT_THAT(with_samples(*process), ElementsAre(0, 0, 0, 1));
}

TEST_F(RetentionTest, KeepsWhatAReaderHasNotReadOrMayNotHave) {
  const auto process = start();
  conclude(*process, 4);
  const std::string writer = process->journal().writer_id();
  process->clock().set(add_seconds(process->clock().now(), 31 * kSecondsPerDay));
  say_read("state_detection", writer, 4);
  say_read("health_assessment", writer, 2);
  let_pass(*process);
  EXPECT_THAT(with_samples(*process), ElementsAre(1, 1, 1, 1)) << "prognosis has not been heard";
  say_read("prognostic_assessment", writer, 4);
  let_pass(*process);
  EXPECT_THAT(with_samples(*process), ElementsAre(0, 0, 1, 1));
}

TEST_F(RetentionTest, KeepsATestThatIsSetAsideUntilItIsNot) {
  const auto process = start();
  conclude(*process, 3);
  const std::string writer = process->journal().writer_id();
  process->clock().set(add_seconds(process->clock().now(), 31 * kSecondsPerDay));
  ServiceAlarm aside;
  aside.kind = "set_aside";
  aside.asset_id = "A";
  aside.pst_id = header_of(process->outputs()[0]).pst_id;
  say_all_read(writer, 3, {aside});
  let_pass(*process);
  EXPECT_THAT(with_samples(*process), ElementsAre(1, 0, 1));
  say_all_read(writer, 3);
  let_pass(*process);
  EXPECT_THAT(with_samples(*process), ElementsAre(0, 0, 1));
}

TEST_F(RetentionTest, KeepsTheJournalWithinItsBound) {
  options_.retention = {.days = 0.0, .megabytes = 0.02};
  const auto process = start();
  conclude(*process, 8);
  process->clock().set(add_seconds(process->clock().now(), 2 * kSecondsPerDay));
  say_all_read(process->journal().writer_id(), 8);
  let_pass(*process);
  EXPECT_THAT(with_samples(*process), ElementsAre(0, 0, 0, 0, 0, 0, 0, 1));
}

TEST_F(RetentionTest, KeepsEverythingWhereNothingIsConfigured) {
  options_.retention = {};
  const auto process = start();
  conclude(*process, 2);
  process->clock().set(add_seconds(process->clock().now(), 1e4 * kSecondsPerDay));
  say_all_read(process->journal().writer_id(), 2);
  let_pass(*process);
  EXPECT_THAT(with_samples(*process), ElementsAre(1, 1));
}

TEST_F(RetentionTest, AReaderPassesOverWhatIsLeftAndReadsOn) {
  std::vector<std::string> given;
  const auto process = start(&given);
  for (const std::uint64_t number : {1U, 2U}) {
    TestWindow window;
    window.asset_id = "A";
    window.header = header("test_window/" + std::to_string(number), std::to_string(number));
    window.header.writer_id = "writer";
    window.header.stream_sequence = number;
    if (number == 1) window.header.producer = "expired: data_manipulation";
    ASSERT_TRUE(bus_.publish(Message(window)));
  }
  ASSERT_TRUE(step_until([&] { return !given.empty(); }, [&] { process->step(); }));
  EXPECT_THAT(given, ElementsAre("test_window/2"));
  EXPECT_TRUE(process->journal().has_input("test_window/1").value());
  EXPECT_EQ(process->journal().open_inputs(), 0U) << "nothing waits for it";
}

}  // namespace
}  // namespace sealwatch::testing
