// Layers in one process conclude what the same layers conclude behind runners, journals and a bus.
#include "services/common/runtime/in_process_pipeline.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/runtime/harness.hpp"

namespace sealwatch::testing {
namespace {

std::vector<Message> in_process(const std::vector<RawSamples>& blocks) {
  std::vector<std::unique_ptr<Layer>> layers;
  layers.push_back(std::make_unique<CuttingLayer>());
  layers.push_back(std::make_unique<JoiningLayer>());
  std::vector<Message> concluded;
  InProcessPipeline pipeline(std::move(layers), [&](const Message& message) { concluded.push_back(message); });
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

}  // namespace
}  // namespace sealwatch::testing
