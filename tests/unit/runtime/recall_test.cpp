// A start does not wait for the history of all assets: an asset's past is recalled before anything is taken of it, and in
// turn; and it comes to the same, killed anywhere.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "services/data_acquisition/data_acquisition.hpp"
#include "tests/unit/runtime/harness.hpp"

namespace sealwatch::testing {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// What each life of the layer was given back.
class RecordingLayer final : public CuttingLayer {
 public:
  explicit RecordingLayer(std::vector<std::string>& restored) : restored_(restored) {}
  void restore(const Message& own) override {
    restored_.push_back(asset_of(own));
    CuttingLayer::restore(own);
  }

 private:
  std::vector<std::string>& restored_;
};

RunnerOptions lazy() {
  RunnerOptions options = fast_options();
  options.recalls_at_start = milliseconds(0);
  return options;
}

/// Remembers hardly anything.
RunnerOptions forgetful() {
  RunnerOptions options = lazy();
  options.most_recalled = 10;
  options.least_awake = milliseconds(0);
  return options;
}

class Recall : public ::testing::Test {
 protected:
  std::unique_ptr<Process> start(RunnerOptions options) {
    restored_.clear();
    auto process = std::make_unique<Process>(
        network_, [this] { return std::make_unique<RecordingLayer>(restored_); }, place_.connection(), Fate(),
        std::move(options));
    process->start();
    return process;
  }
  void feed(Process& process, Feeder& feeder, std::size_t blocks) {
    feeder.send(blocks);
    feeder.beat();
    process.step();
  }

  Place place_;
  std::shared_ptr<InMemoryNetwork> network_ = std::make_shared<InMemoryNetwork>();
  std::vector<std::string> restored_;
};

TEST_F(Recall, AStartReadsNoHistoryAndAnAssetsComesBeforeItsNextMessage) {
  auto blocks = blocks_of_tests(5, {"A", "B", "C"});
  Feeder feeder(network_, blocks);
  {
    const auto process = start(fast_options());
    while (process->outputs().size() < 2 * 4 * 3) feed(*process, feeder, 3);
  }
  const auto process = start(lazy());
  EXPECT_THAT(restored_, IsEmpty());
  // The rest of the blocks: those of B first, as it happens.
  InMemoryBus other(network_);
  RawSamples news = blocks.at(1);
  news.asset_id = "B";
  news.recording_id = "B test 77";
  news.boundary = BlockBoundary::end;
  news.header = header("raw_samples/B test 77/0", "");
  ASSERT_TRUE(other.publish(Message(news)));
  process->step();
  ASSERT_GE(restored_.size(), 8U);
  EXPECT_EQ(std::vector<std::string>(restored_.begin(), restored_.begin() + 8), std::vector<std::string>(8, "B"));
  ASSERT_TRUE(step_until([&] { return restored_.size() == 3 * 8; }, [&] { process->step(); }));
  for (int k = 0; k < 5; ++k) process->step();
  EXPECT_THAT(restored_, SizeIs(3 * 8)) << "each once";
}

/// Twenty years of many assets take no more memory than a year of one: those that are asleep are recalled when something
/// is taken of them, or when it is time to look after them.
TEST_F(Recall, AssetsThatWereNotUsedForLongestForgetTheirPast) {
  Feeder feeder(network_, blocks_of_tests(4, {"A", "B", "C"}));
  {
    const auto process = start(fast_options());
    while (process->outputs().size() < 2 * 4 * 3) feed(*process, feeder, 3);
  }
  auto process = start(forgetful());
  ASSERT_TRUE(step_until([&] { return restored_.size() == 3 * 8; }, [&] { process->step(); }));
  for (int k = 0; k < 5; ++k) process->step();
  EXPECT_THAT(restored_, SizeIs(3 * 8)) << "at rest, nobody is woken";

  restored_.clear();
  InMemoryBus other(network_);
  RawSamples news = blocks_of_tests(1, {"A"}).at(1);
  news.recording_id = "A test 77";
  news.boundary = BlockBoundary::end;
  news.header = header("raw_samples/A test 77/0", "");
  ASSERT_TRUE(other.publish(Message(news)));
  process->step();
  EXPECT_EQ(restored_, std::vector<std::string>(8, "A")) << "forgotten as the first of three";

  restored_.clear();
  process.reset();
  RunnerOptions options = forgetful();
  options.longest_sleep = milliseconds(0);
  process = start(options);
  const auto all_twice = [&] {
    return restored_.size() > 50 && std::set<std::string>(restored_.begin() + 25, restored_.end()).size() == 3;
  };
  EXPECT_TRUE(step_until(all_twice, [&] { process->step(); })) << "time passes for all of them, in turn";
}

TEST_F(Recall, TheHeartbeatSaysWhenAllIsThere) {
  Feeder feeder(network_, blocks_of_tests(2, {"A", "B"}));
  {
    const auto process = start(fast_options());
    while (process->outputs().size() < 8) feed(*process, feeder, 4);
  }
  InMemoryBus listener(network_);
  ASSERT_TRUE(listener.subscribe_service_topics());
  auto process = start(lazy());
  std::vector<std::string> states;
  const auto listen = [&] {
    process->step();
    for (const BusItem& item : listener.receive(milliseconds(1), 100))
      if (const auto* status = std::get_if<ServiceStatus>(&item); status && status->service == "data_acquisition")
        states.push_back(status->state);
  };
  ASSERT_TRUE(step_until([&] { return !states.empty() && states.back() == "running"; }, listen));
  process.reset();
  process = start(fast_options());
  EXPECT_THAT(restored_, SizeIs(8)) << "a short history is recalled at once";
}

/// Outputs by asset, in order, each as exact as its journal.
std::map<std::string, std::vector<Message>> by_asset(Process& process) {
  std::map<std::string, std::vector<Message>> outputs;
  for (Message& message : process.outputs()) outputs[asset_of(message)].push_back(std::move(message));
  return outputs;
}

/// Of data acquisition, which is given back the last word on each test alone, and of a layer that is given all: killed at every step and started again, with its past recalled at once or as late as may be.
template <class MakeLayer>
void expect_the_same_however_killed(const MakeLayer& make_layer, const std::vector<RawSamples>& blocks,
                                    bool is_packed = false) {
  int steps = 0;
  const auto run = [&](int fatal_step, const RunnerOptions& options) {
    const Place place;
    auto network = std::make_shared<InMemoryNetwork>();
    Feeder feeder(network, blocks);
    std::unique_ptr<Process> process;
    int lives = 0;
    const auto step = [&] {
      feeder.send(1);
      feeder.beat();
      try {
        if (!process) {
          process = std::make_unique<Process>(network, make_layer, place.connection(),
                                              Fate(lives++ == 0 ? fatal_step : -1), options);
          process->start();
        }
        process->step();
        if (lives == 1) steps = process->steps();
      } catch (const Killed&) {
        process.reset();
      }
    };
    const auto done = [&] { return process && feeder.all_received() && process->journal().open_inputs() == 0; };
    EXPECT_TRUE(step_until(done, step)) << "killed at step " << fatal_step;
    process.reset();  // and once more from the start
    process = std::make_unique<Process>(network, make_layer, place.connection(), Fate(), options);
    process->start();
    for (int k = 0; k < 3; ++k) process->step();
    int packed = 0;
    soci::session(place.connection()) << "SELECT count(*) FROM packed_outputs", soci::into(packed);
    EXPECT_EQ(packed > 0, is_packed);
    return by_asset(*process);
  };
  const auto undisturbed = run(-1, fast_options());
  const int last = steps;
  ASSERT_GT(last, 20);
  EXPECT_EQ(run(-1, lazy()), undisturbed);
  for (int fatal_step = 1; fatal_step <= last; ++fatal_step)
    ASSERT_EQ(run(fatal_step, forgetful()), undisturbed) << "killed at step " << fatal_step;
}

TEST(RecallAfterKills, OfALayerThatIsGivenAllComesToTheSame) {
  expect_the_same_however_killed([] { return std::make_unique<CuttingLayer>(); }, blocks_of_tests(3, {"A", "B"}));
}

TEST(RecallAfterKills, OfALongerPastThatIsPackedComesToTheSame) {
  expect_the_same_however_killed([] { return std::make_unique<CuttingLayer>(); }, blocks_of_tests(10, {"A"}), true);
}

/// Two blocks a test; asset B's second test is cut by its third, A's last is played twice.
TEST(RecallAfterKills, OfDataAcquisitionComesToTheSame) {
  auto blocks = blocks_of_tests(3, {"A", "B"});
  std::int64_t start = 1'800'000'000'000'000'000;
  for (RawSamples& block : blocks) {
    block.start_time_known = true;
    block.start_time_ns = start + 1'000'000'000'000 * (block.recording_id.back() - '0');
    block.source_id = "plc";
    const double begin = 10.0 * static_cast<double>(block.block_number);
    for (int row = 0; row < 20; ++row) block.samples.time_s.push_back(begin + 0.5 * row);
    block.samples.channels.push_back(
        {.name = "position", .unit = "m", .noise_std = 0.0, .values = std::vector<double>(20, 0.01)});
  }
  std::erase_if(blocks, [](const RawSamples& b) { return b.recording_id == "B test 1" && b.block_number == 1; });
  for (const std::size_t again : {0U, 2U}) {
    RawSamples known = blocks.at(again);
    known.header.message_id += "/again";
    blocks.push_back(known);
  }
  expect_the_same_however_killed(
      [] { return std::make_unique<DataAcquisition>(std::vector<AssetConfig>{}, DataAcquisitionOptions{}); }, blocks);
}

}  // namespace
}  // namespace sealwatch::testing
