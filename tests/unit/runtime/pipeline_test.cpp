// Layers in one process conclude what the same layers conclude behind runners, journals and a bus.
#include "services/common/runtime/in_process_pipeline.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/runtime/harness.hpp"

namespace sealwatch::testing {
namespace {

std::vector<Message> in_process(const std::vector<RawSamples>& blocks) {
  const std::vector<LayerMaker> layers = {[](const std::string&) { return std::make_unique<CuttingLayer>(); },
                                          [](const std::string&) { return std::make_unique<JoiningLayer>(); }};
  std::vector<Message> concluded;
  InProcessPipeline pipeline(layers, [&](const Message& message) { concluded.push_back(message); });
  for (const RawSamples& block : blocks) pipeline.push(Message(block));
  return concluded;
}

std::vector<Message> over_a_bus(const std::vector<RawSamples>& blocks, std::size_t reports) {
  const Place place_1;
  const Place place_2;
  auto network = std::make_shared<InMemoryNetwork>();
  Process cutter(
      network, [] { return std::make_unique<CuttingLayer>(); }, place_1.connection());
  Process joiner(
      network, [] { return std::make_unique<JoiningLayer>(); }, place_2.connection());
  cutter.start();
  joiner.start();
  Feeder feeder(network, blocks);
  feeder.send(blocks.size());
  EXPECT_TRUE(step_until([&] { return joiner.outputs().size() == reports; },
                         [&] {
                           cutter.step();
                           joiner.step();
                         }));
  std::vector<Message> all = cutter.outputs();
  for (const Message& message : joiner.outputs()) all.push_back(message);
  return all;
}

TEST(InProcessPipelineTest, ConcludesTheSameAsServicesDo) {
  const std::vector<RawSamples> blocks = blocks_of_tests(4, {"A", "B"});
  const std::vector<Message> concluded = in_process(blocks);
  EXPECT_EQ(concluded.size(), 24U);
  EXPECT_THAT(concluded, ::testing::UnorderedElementsAreArray(over_a_bus(blocks, 8)));
  EXPECT_EQ(concluded, in_process(blocks)) << "and in the same order every time";
}

/// Which of the two keeps the id goes by who is first, and services conclude from both at once.
TEST(InProcessPipelineTest, TestsOfTwoAssetsWithOneIdAreConcludedAsServicesDo) {
  std::vector<RawSamples> blocks = blocks_of_tests(2, {"XT_1", "XT 1"});
  for (RawSamples& block : blocks)
    block.recording_id = "april" + block.recording_id.substr(block.recording_id.size() - 1);
  const auto of_which_tests = [](const std::vector<Message>& messages) {
    std::vector<std::string> tests;
    for (const Message& message : messages)
      tests.push_back(asset_of(message) + " " + header_of(message).pst_id + " " +
                      std::string(name_of(topic_of(message))));
    return tests;
  };
  const std::vector<Message> concluded = in_process(blocks);
  EXPECT_EQ(concluded.size(), 12U);
  EXPECT_THAT(of_which_tests(concluded), ::testing::UnorderedElementsAreArray(of_which_tests(over_a_bus(blocks, 4))));
}

TEST(InProcessPipelineTest, TakesAMessageOnce) {
  std::vector<RawSamples> twice = blocks_of_tests(2, {"A"});
  const std::vector<Message> once = in_process(twice);
  for (const RawSamples& block : blocks_of_tests(2, {"A"})) twice.push_back(block);
  EXPECT_EQ(in_process(twice), once);
}

TEST(InProcessPipelineTest, GivesForeignMessagesTheIdsThatServicesGiveThem) {
  std::vector<RawSamples> blocks = blocks_of_tests(2, {"A"});
  for (RawSamples& block : blocks) block.header.message_id.clear();
  std::vector<RawSamples> bare = blocks;
  const Place place;
  auto network = std::make_shared<InMemoryNetwork>();
  Process cutter(
      network, [] { return std::make_unique<CuttingLayer>(); }, place.connection());
  cutter.start();
  InMemoryBus sender(network);
  for (const RawSamples& block : bare) EXPECT_TRUE(sender.publish(Message(block)));
  cutter.step();
  const std::vector<Message> served = cutter.outputs();
  ASSERT_EQ(served.size(), 4U);
  std::vector<Message> concluded;
  for (const Message& message : in_process(blocks))
    if (topic_of(message) != Topic::health_report) concluded.push_back(message);
  EXPECT_EQ(concluded, served) << "the test's content is chained from the blocks' ids";
}

/// Raises an exception on one test of asset A, which does not end on another.
class FailingLayer final : public Layer {
 public:
  [[nodiscard]] std::string_view name() const override { return "health_assessment"; }
  [[nodiscard]] std::span<const Topic> inputs() const override { return kInputs; }
  [[nodiscard]] std::span<const Topic> outputs() const override { return kOutputs; }
  void restore(const Message& /*own*/) override { ++tests_; }
  [[nodiscard]] Conclusion receive(const Message& input) override {
    ++tests_;
    const std::string& test = header_of(input).pst_id;
    if (test == "A test 1") throw std::runtime_error("no such phase");
    if (test == "A test 2") waits = true;
    while (test == "A test 2" && !released.load()) continue;
    HealthReport report;
    report.asset_id = asset_of(input);
    report.header = header("health_report/" + test, test);
    report.inadmissible_reasons = {"test " + std::to_string(tests_)};
    return {{report}, {header_of(input).message_id}};
  }
  inline static std::atomic<bool> released = false;
  inline static std::atomic<bool> waits = false;  ///< on that which does not end

 private:
  static constexpr std::array kInputs = {Topic::test_features};
  static constexpr std::array kOutputs = {Topic::health_report};
  int tests_ = 0;
};

TEST(InProcessPipelineTest, SetsAsideWhatFailsTwiceAndGoesOn) {
  const std::vector<LayerMaker> layers = {[](const std::string&) { return std::make_unique<CuttingLayer>(); },
                                          [](const std::string&) { return std::make_unique<FailingLayer>(); }};
  std::vector<std::string> concluded;
  std::vector<std::string> set_aside;
  AssetLanes::Options impatient;
  impatient.workers.deadline = std::chrono::milliseconds(100);
  impatient.workers.grace = std::chrono::milliseconds(100);
  FailingLayer::released = false;
  InProcessPipeline pipeline(
      layers,
      [&](const Message& message) {
        if (const auto* report = std::get_if<HealthReport>(&message))
          concluded.push_back(report->header.pst_id + ": " + report->inadmissible_reasons.front());
      },
      [&](std::string_view layer, const Message& input, const std::string& why) {
        set_aside.push_back(std::string(layer) + " " + header_of(input).pst_id + ": " + why);
      },
      impatient);
  for (const RawSamples& block : blocks_of_tests(4, {"A", "B"})) pipeline.push(Message(block));
  EXPECT_TRUE(pipeline.hangs());
  FailingLayer::released = true;  // or the end of the pipeline would wait for it
  EXPECT_THAT(concluded, ::testing::ElementsAre("A test 0: test 1", "B test 0: test 1", "B test 1: test 2",
                                                "B test 2: test 3", "A test 3: test 2", "B test 3: test 4"));
  EXPECT_THAT(set_aside, ::testing::ElementsAre("health_assessment A test 1: no such phase",
                                                ::testing::StartsWith("health_assessment A test 2: it did not end")));
}

TEST(InProcessPipelineTest, LeavesTheRestUndoneWhereItIsToldTo) {
  const std::vector<LayerMaker> layers = {[](const std::string&) { return std::make_unique<CuttingLayer>(); },
                                          [](const std::string&) { return std::make_unique<FailingLayer>(); }};
  FailingLayer::released = FailingLayer::waits = false;
  std::size_t reports = 0;
  InProcessPipeline pipeline(
      layers, [&reports](const Message& message) { reports += topic_of(message) == Topic::health_report ? 1 : 0; });
  pipeline.stop_when([] { return FailingLayer::waits.load(); });
  for (const RawSamples& block : blocks_of_tests(4, {"A"})) pipeline.push(Message(block));
  EXPECT_TRUE(pipeline.hangs());
  EXPECT_EQ(reports, 1U) << "of the first test; the second fails, the third does not end";
  FailingLayer::released = true;  // or the end of the pipeline would wait for it
}

}  // namespace
}  // namespace sealwatch::testing
