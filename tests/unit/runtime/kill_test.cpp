// Two services in a row, one of them killed at every step it takes, in turn, and started again: they end with the same
// outputs as two that were left alone, and hand every message on.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tests/unit/runtime/harness.hpp"

namespace sealwatch::testing {
namespace {

constexpr int kTests = 2;
const std::vector<std::string> kAssets = {"XT03-MV2", "XT04-MV2"};

std::unique_ptr<Layer> cutting() { return std::make_unique<CuttingLayer>(); }
std::unique_ptr<Layer> joining() { return std::make_unique<JoiningLayer>(); }

/// What each asset's messages led to, in order. Between assets any order is right: they have lanes of their own.
using OutputsByAsset = std::map<std::string, std::vector<Message>>;

OutputsByAsset outputs_by_asset(Process& process) {
  OutputsByAsset outputs;
  for (Message& output : process.outputs()) {
    const std::string asset_id = asset_of(output);
    outputs[asset_id].push_back(std::move(output));
  }
  return outputs;
}

std::size_t count(const OutputsByAsset& outputs) {
  std::size_t found = 0;
  for (const auto& [asset_id, of_asset] : outputs) found += of_asset.size();
  return found;
}

struct Outcome {
  OutputsByAsset upstream;
  OutputsByAsset downstream;
  int steps = 0;  ///< of the process that was to be killed, in its first life
  bool finished = false;
};

enum class Victim { upstream, downstream };

Outcome run(Victim victim, int fatal_step) {
  const Place place_1;
  const Place place_2;
  auto network = std::make_shared<InMemoryNetwork>();
  Feeder feeder(network, blocks_of_tests(kTests, kAssets));
  std::unique_ptr<Process> upstream;
  std::unique_ptr<Process> downstream;
  Outcome result;
  int lives = 0;
  // One life of the victim after the other; what is raised is the SIGKILL.
  const auto live = [&](std::unique_ptr<Process>& process, const Place& place, const Process::LayerFactory& layer,
                        bool mortal) {
    try {
      if (!process) {
        process =
            std::make_unique<Process>(network, layer, place.connection(), Fate(mortal && lives == 0 ? fatal_step : -1));
        lives += mortal ? 1 : 0;
        process->start();
      }
      process->step();
      if (mortal && lives == 1) result.steps = process->steps();
    } catch (const Killed&) {
      process.reset();
    }
  };
  const std::size_t reports = kTests * kAssets.size();
  const auto step = [&] {
    feeder.send(1);
    feeder.beat();
    live(upstream, place_1, cutting, victim == Victim::upstream);
    live(downstream, place_2, joining, victim == Victim::downstream);
  };
  const auto done = [&] {
    return feeder.all_received() && downstream && downstream->journal().written().contains(Topic::health_report) &&
           downstream->journal().written().at(Topic::health_report) == reports && upstream &&
           downstream->journal().open_inputs() == 0;
  };
  result.finished = step_until(done, step);
  for (int extra = 0; extra < 3 || !upstream || !downstream; ++extra) step();
  result.upstream = outputs_by_asset(*upstream);
  result.downstream = outputs_by_asset(*downstream);
  return result;
}

class KillTest : public ::testing::TestWithParam<Victim> {};

INSTANTIATE_TEST_SUITE_P(Victims, KillTest, ::testing::Values(Victim::upstream, Victim::downstream),
                         [](const auto& victim) {
                           return victim.param == Victim::upstream ? "upstream" : "downstream";
                         });

TEST_P(KillTest, AtAnyStepEndsWithTheSameOutputs) {
  const Outcome undisturbed = run(GetParam(), -1);
  ASSERT_TRUE(undisturbed.finished);
  ASSERT_EQ(count(undisturbed.upstream), 2 * kTests * kAssets.size());
  ASSERT_EQ(count(undisturbed.downstream), kTests * kAssets.size());
  ASSERT_GT(undisturbed.steps, 20);
  for (int fatal_step = 1; fatal_step <= undisturbed.steps; ++fatal_step) {
    const Outcome disturbed = run(GetParam(), fatal_step);
    ASSERT_TRUE(disturbed.finished) << "killed at step " << fatal_step;
    ASSERT_EQ(disturbed.upstream, undisturbed.upstream) << "killed at step " << fatal_step;
    ASSERT_EQ(disturbed.downstream, undisturbed.downstream) << "killed at step " << fatal_step;
  }
}

/// Like the test above, for a layer that concludes in another thread: killed at every step in turn.
TEST(KillWhileConcludingLater, AtAnyStepEndsWithTheSameOutputs) {
  int steps = 0;
  const auto outputs_after = [&steps](int fatal_step) {
    const Place place;
    auto network = std::make_shared<InMemoryNetwork>();
    Feeder feeder(network, blocks_of_tests(kTests, kAssets));
    std::unique_ptr<Process> process;
    int lives = 0;
    const auto step = [&] {
      std::this_thread::sleep_for(std::chrono::microseconds(200));  // a step is not to be a mere wait for what is later
      feeder.send(1);
      feeder.beat();
      try {
        if (!process) {
          process = std::make_unique<Process>(
              network, [] { return std::make_unique<PatientLayer>(std::chrono::milliseconds(2)); }, place.connection(),
              Fate(lives++ == 0 ? fatal_step : -1));
          process->start();
        }
        process->step();
        if (lives == 1) steps = process->steps();
      } catch (const Killed&) {
        process.reset();
      }
    };
    const auto done = [&] {
      return process && feeder.all_received() && process->journal().open_inputs() == 0 &&
             process->outputs().size() == kTests * kAssets.size();
    };
    EXPECT_TRUE(step_until(done, step)) << "killed at step " << fatal_step;
    return outputs_by_asset(*process);
  };
  const OutputsByAsset undisturbed = outputs_after(-1);
  const int last = steps;
  ASSERT_GT(last, 15);
  for (int fatal_step = 1; fatal_step <= last; ++fatal_step)
    ASSERT_EQ(outputs_after(fatal_step), undisturbed) << "killed at step " << fatal_step;
}

}  // namespace
}  // namespace sealwatch::testing
