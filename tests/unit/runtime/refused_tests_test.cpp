// Tests that are refused are told of, by asset and sender, until the sender is mended; whoever invents them hides no other
// alarm.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/runtime/harness.hpp"

namespace sealwatch::testing {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

constexpr std::int64_t kOneDay_ns = 86'400'000'000'000;

class RefusedTests : public ::testing::Test {
 protected:
  RefusedTests() { EXPECT_TRUE(bus_.subscribe_service_topics()); }
  void start(const std::vector<std::string>& assets,
             std::chrono::milliseconds refusals_stand = RunnerOptions().refusals_stand) {
    RunnerOptions options = fast_options();
    options.assets = assets;
    options.refusals_stand = refusals_stand;
    process_.reset();
    process_ = std::make_unique<Process>(
        network_, [] { return std::make_unique<CuttingLayer>(); }, place_.connection(), Fate(), options);
    process_->start();
  }
  /// A test that began so many days from now.
  void send(const std::string& asset_id, const std::string& source_id, std::int64_t days,
            const std::string& recording_id = {}) {
    RawSamples block;
    block.asset_id = asset_id;
    block.source_id = source_id;
    block.recording_id = recording_id.empty() ? "recording " + std::to_string(sent_ + 1) : recording_id;
    block.boundary = BlockBoundary::end;
    block.start_time_known = true;
    block.start_time_ns = process_->clock().now().nanoseconds + days * kOneDay_ns;
    block.header.writer_id = "sender";
    block.header.stream_sequence = ++sent_;
    block.header.message_id = "raw/" + std::to_string(sent_);
    ASSERT_TRUE(bus_.publish(Message(block)));
  }
  void beat_of_rival(const std::string& state) {
    ServiceStatus rival;
    rival.service = "data_acquisition";
    rival.writer_id = "rival";
    rival.state = state;
    ASSERT_TRUE(bus_.publish(rival));
  }
  void step() {
    process_->step();
    for (const BusItem& item : bus_.receive(std::chrono::milliseconds(1), 100'000))
      if (const auto* status = std::get_if<ServiceStatus>(&item);
          status && status->writer_id == process_->journal().writer_id())
        last_ = *status;
  }
  /// Kind, asset and subject of each alarm, once all is taken and told.
  std::vector<std::string> alarms() {
    EXPECT_TRUE(
        step_until([&] { return sent_ == 0 || (!last_.received.empty() && last_.received[0].sequence == sent_); },
                   [&] { step(); }, std::chrono::seconds(60)));
    step_for(std::chrono::milliseconds(1100), [&] { step(); });
    EXPECT_EQ(last_.alarm_count, last_.alarms.size()) << "the desk ends none otherwise";
    std::vector<std::string> told;
    for (const ServiceAlarm& alarm : last_.alarms)
      told.push_back(alarm.kind + "/" + alarm.asset_id + "/" + alarm.subject);
    return told;
  }

  Place place_;
  std::shared_ptr<InMemoryNetwork> network_ = std::make_shared<InMemoryNetwork>();
  InMemoryBus bus_{network_};
  std::unique_ptr<Process> process_;
  std::uint64_t sent_ = 0;
  ServiceStatus last_;
};

TEST_F(RefusedTests, OfInventedAssetsShareOneAlarmAndHideNoOther) {
  start({"A"});
  beat_of_rival("running");
  step();
  for (int k = 0; k < 1000; ++k) send("invented-" + std::to_string(k), "plc", 5000);
  EXPECT_THAT(alarms(), UnorderedElementsAre("rival//rival", "refused_test//"));
  beat_of_rival("stopping");
  EXPECT_THAT(alarms(), ElementsAre("refused_test//"));
}

TEST_F(RefusedTests, OfManyAssetsNameTheFirstAndHideNoOther) {
  std::vector<std::string> assets;
  for (int k = 100; k < 200; ++k) assets.push_back("A" + std::to_string(k));
  start(assets);
  beat_of_rival("running");
  step();
  for (const std::string& asset_id : assets) send(asset_id, "plc", 5000);
  EXPECT_THAT(alarms(), SizeIs(1 + 8 + 1));
  EXPECT_THAT(last_.alarms, Contains(Field(&ServiceAlarm::kind, "rival")));
  EXPECT_THAT(last_.alarms, Contains(Field(&ServiceAlarm::text, HasSubstr("tests of 92 more are refused, among them: "
                                                                          "recording recording 9 of A108: "))));
  beat_of_rival("stopping");
  for (std::size_t k = 0; k < 99; ++k) send(assets[k], "plc", 1);
  EXPECT_THAT(alarms(), ElementsAre("refused_test/A199/plc"));
}

TEST_F(RefusedTests, OfInventedSendersTakeTheRoomOfAFew) {
  start({"A", "B"});
  for (int k = 0; k < 1000; ++k) send("A", "invented-" + std::to_string(k), 5000);
  send("B", "plc", 5000);
  EXPECT_THAT(alarms(), SizeIs(5));
  EXPECT_EQ(last_.alarms.back().asset_id, "B");
}

TEST_F(RefusedTests, AreOverWithANewerOneOfTheSameSender) {
  start({"A"});
  send("A", "plc", 5000, "april");
  EXPECT_THAT(alarms(), ElementsAre("refused_test/A/plc"));
  send("A", "recordings_folder", -400);
  send("A", "plc", -400);
  send("A", "bench 2", 1);
  EXPECT_THAT(alarms(), ElementsAre("refused_test/A/plc")) << "its sender's clock is as wrong as before";
  send("A", "plc", 1);
  EXPECT_THAT(alarms(), IsEmpty());
  send("A", "recordings_folder", 5000, "may");
  EXPECT_THAT(alarms(), SizeIs(1));
  send("A", "recordings_folder", -30, "may");
  EXPECT_THAT(alarms(), IsEmpty()) << "it is corrected";
}

TEST_F(RefusedTests, AreToldOfAfterARestartTooAndNotForEver) {
  start({"A"});
  send("A", "plc", 5000);
  send("A", "gone", 5000);
  EXPECT_THAT(alarms(), SizeIs(2));
  const std::int64_t since_ns = last_.alarms.at(0).since_ns;
  start({"A"});
  EXPECT_THAT(alarms(), UnorderedElementsAre("refused_test/A/plc", "refused_test/A/gone"));
  EXPECT_EQ(last_.alarms.at(0).since_ns, since_ns);
  send("A", "plc", 1);
  EXPECT_THAT(alarms(), ElementsAre("refused_test/A/gone"));
  start({"A"});
  EXPECT_THAT(alarms(), ElementsAre("refused_test/A/gone"));
  start({"A"}, std::chrono::milliseconds(200));
  EXPECT_TRUE(step_until([&] { return last_.alarms.empty(); }, [&] { step(); }, std::chrono::seconds(60)));
}

}  // namespace
}  // namespace sealwatch::testing
