// What a late subscriber finds of every asset where tests come late.
#include "services/common/runtime/latest_outputs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <optional>

#include "tests/unit/runtime/harness.hpp"

namespace sealwatch::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

const LatestOutputs::Key kKey{Topic::test_features, "A"};

Message of_event(std::uint64_t sequence, std::optional<std::int64_t> event_time_ns) {
  TestFeatures message;
  message.asset_id = "A";
  message.header.stream_sequence = sequence;
  message.header.event_time_known = event_time_ns.has_value();
  message.header.event_time_ns = event_time_ns.value_or(0);
  return message;
}

LatestOutputs after(const std::vector<Message>& outputs) {
  LatestOutputs latest;
  for (const Message& output : outputs) {
    latest.concluded(output, header_of(output).stream_sequence);
    latest.published(output);
  }
  return latest;
}

TEST(LatestOutputs, InOrderNothingIsToBePublishedAgain) {
  EXPECT_THAT(after({of_event(1, 10), of_event(2, 20), of_event(3, 20)}).to_publish(), IsEmpty());
  EXPECT_THAT(after({of_event(1, {}), of_event(2, {}), of_event(3, 20)}).to_publish(), IsEmpty());
}

TEST(LatestOutputs, AfterALateEventTheLatestIsToBePublishedAgainOnce) {
  LatestOutputs latest = after({of_event(1, 10), of_event(2, 20), of_event(3, 5)});
  EXPECT_THAT(latest.to_publish(), ElementsAre(Pair(kKey, 2)));
  latest.published(of_event(2, 20));
  EXPECT_THAT(latest.to_publish(), IsEmpty());
  latest.published(of_event(1, 10));  // sent again
  EXPECT_THAT(latest.to_publish(), ElementsAre(Pair(kKey, 2)));
}

TEST(LatestOutputs, OneWithoutTimeIsNotTheLatestOfThoseThatHaveOne) {
  EXPECT_THAT(after({of_event(1, 10), of_event(2, {})}).to_publish(), ElementsAre(Pair(kKey, 1)));
}

/// It has the time of the act, not of a test. In a journal that is made again it comes before the tests.
TEST(LatestOutputs, ThatNoTestCountsStandsUntilATestIsConcluded) {
  Message none = of_event(1, 1000);
  header_of(none).source_ids = {"retraction/A/test/A-2/2031-01-01T00:00:00Z",
                                "state_report/retraction/A/test/A-2/2031-01-01T00:00:00Z"};
  EXPECT_THAT(after({none}).to_publish(), IsEmpty());
  EXPECT_TRUE(after({none, of_event(2, 20)}).is_latest(kKey.first, kKey.second, 2));
}

TEST(LatestOutputs, WhatIsConcludedAnewAfterARetractionIsTheLatestThoughItSpeaksOfAnEarlierTest) {
  Message anew = of_event(3, 10);
  header_of(anew).source_ids = {"retraction/A/test/A-2/2031-01-01T00:00:00Z"};
  EXPECT_THAT(after({of_event(1, 10), of_event(2, 20), anew}).to_publish(), IsEmpty());
  EXPECT_THAT(after({of_event(1, 10), of_event(2, 20), anew, of_event(4, 15)}).to_publish(), IsEmpty());
}

TEST(LatestOutputs, WhatWasConcludedAndNotPublishedIsToBePublished) {
  LatestOutputs latest;
  latest.concluded(of_event(1, 10), 1);
  EXPECT_THAT(latest.to_publish(), ElementsAre(Pair(kKey, 1)));
  latest.published(of_event(1, 10));
  EXPECT_THAT(latest.to_publish(), IsEmpty());
}

class LateTest : public ::testing::Test {
 protected:
  LateTest() {
    EXPECT_TRUE(listener_.subscribe(std::array{Topic::test_features}));
    auto blocks = blocks_of_tests(3, {"A"});
    const std::array<std::int64_t, 3> times = {10, 20, 5};
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      blocks[k].header.event_time_known = true;
      blocks[k].header.event_time_ns = times.at(k / 2);
    }
    feeder_.emplace(network_, std::move(blocks));
    start();
    feeder_->send(6);
  }
  void start() {
    process_.reset();
    process_ = std::make_unique<Process>(
        network_, [] { return std::make_unique<CuttingLayer>(); }, place_.connection());
    process_->start();
  }
  /// The sequence numbers that were published since the last look.
  std::vector<std::uint64_t> published() {
    std::vector<std::uint64_t> found;
    for (const BusItem& item : listener_.receive(std::chrono::milliseconds(0), 100))
      if (const auto* message = std::get_if<Message>(&item)) found.push_back(header_of(*message).stream_sequence);
    return found;
  }

  Place place_;
  std::shared_ptr<InMemoryNetwork> network_ = std::make_shared<InMemoryNetwork>();
  InMemoryBus listener_{network_};
  std::optional<Feeder> feeder_;
  std::unique_ptr<Process> process_;
};

TEST_F(LateTest, DoesNotStayTheLastOnePublished) {
  std::vector<std::uint64_t> all;
  EXPECT_TRUE(step_until([&] { return all.size() >= 4; },
                         [&] {
                           process_->step();
                           for (const std::uint64_t sequence : published()) all.push_back(sequence);
                         }));
  EXPECT_THAT(all, ElementsAre(1, 2, 3, 2));
}

TEST_F(LateTest, IsNotWhatIsPublishedAgainAtTheStart) {
  EXPECT_TRUE(step_until([&] { return process_->outputs().size() == 6; }, [&] { process_->step(); }));
  (void)published();
  start();
  EXPECT_THAT(published(), ElementsAre(2));
}

}  // namespace
}  // namespace sealwatch::testing
