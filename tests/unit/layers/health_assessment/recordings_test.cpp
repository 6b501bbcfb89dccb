// The layers up to health assessment over the public recordings: what they say must make sense to an operator. Passes
// over what is not there.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "services/common/model/model_simulator.hpp"
#include "services/common/recording/recording_file.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "services/common/runtime/in_process_pipeline.hpp"
#include "services/data_acquisition/data_acquisition.hpp"
#include "services/data_acquisition/recording_blocks.hpp"
#include "services/data_manipulation/data_manipulation.hpp"
#include "services/health_assessment/health_assessment.hpp"
#include "services/state_detection/state_detection.hpp"

namespace sealwatch {
namespace {

using testing::Contains;
using testing::HasSubstr;

struct Life {
  std::vector<StateReport> states;
  std::vector<HealthReport> healths;
};

/// Plays the recordings whose names begin with one of `names`, in order.
Life play(const AssetConfig& asset, const std::filesystem::path& folder, const std::vector<std::string>& names,
          const std::shared_ptr<const Simulator>& simulator) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    const bool wanted = std::any_of(names.begin(), names.end(), [&](const auto& n) { return name.starts_with(n); });
    if (wanted && entry.path().extension() == ".csv") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  Life life;
  const std::vector<AssetConfig> assets = {asset};
  const std::vector<LayerMaker> layers = {
      [&](const std::string&) { return std::make_unique<DataAcquisition>(assets); },
      [&](const std::string&) { return std::make_unique<DataManipulation>(assets); },
      [&](const std::string&) { return std::make_unique<StateDetection>(assets, simulator); },
      [&](const std::string&) { return std::make_unique<HealthAssessment>(assets); }};
  InProcessPipeline pipeline(layers, [&](const Message& message) {
    if (const auto* state = std::get_if<StateReport>(&message)) life.states.push_back(*state);
    if (const auto* health = std::get_if<HealthReport>(&message)) life.healths.push_back(*health);
  });
  const auto plant = find_plant(asset.model);
  for (const auto& file : files) {
    auto recording = read_recording(file, **plant);
    EXPECT_TRUE(recording) << recording.error().describe();
    recording->asset_id = asset.asset_id;
    for (const RawSamples& block : blocks_of(*recording)) pipeline.push(block);
  }
  return life;
}

AssetConfig asset_from(const std::string& yaml) {
  const std::string file = SEALWATCH_BINARY_DIR "/recordings_test_asset.yaml";
  std::ofstream(file) << yaml;
  auto asset = load_asset(file);
  EXPECT_TRUE(asset) << asset.error().describe();
  return *asset;
}

std::string date_of(const Header& header) { return format_date(UtcTime{header.event_time_ns}); }

TEST(Recordings, NineYearsOfSlowLeakage) {
  const std::filesystem::path folder = SEALWATCH_SHARED_DATA "/pst_life/xt03-mv2";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  const AssetConfig asset = asset_from("{asset_id: XT03-MV2, model: eha}");
  const Life life = play(asset, folder, {"20"}, nullptr);
  ASSERT_EQ(life.states.size(), 105U);
  ASSERT_EQ(life.healths.size(), 105U);

  std::vector<std::string> late;
  AlertRegion worst = AlertRegion::normal;
  for (std::size_t k = 0; k < life.states.size(); ++k) {
    const StateReport& state = life.states[k];
    const HealthReport& health = life.healths[k];
    const std::string date = date_of(state.header);
    const bool cut = date.starts_with("2010-11");
    EXPECT_EQ(state.verdict, cut ? PstVerdict::not_judged : PstVerdict::passed) << date;
    EXPECT_EQ(health.admissible_for_prognosis, !cut) << date;
    EXPECT_GE(state.region, worst) << "no flapping, " << date;
    worst = state.region;
    if (state.pst_overdue) late.push_back(date.substr(0, 7));
    for (const ProposedFault& fault : health.ambiguity_group)
      EXPECT_TRUE(fault.kind == FaultKind::internal_leakage || fault.likelihood < 0.2) << date << " " << fault.element;
  }
  // Tests after a month without one, and after the cut one.
  EXPECT_THAT(late, testing::ElementsAre("2010-12", "2015-07", "2017-09", "2017-11"));
  EXPECT_EQ(worst, AlertRegion::warning);
  EXPECT_GT(life.healths.front().health_grade, 0.9);
  EXPECT_LT(life.healths.back().health_grade, 0.1);
  EXPECT_GT(life.healths.back().health_grade, 0.0);
  EXPECT_GT(life.healths.back().ambiguity_group.front().likelihood, 0.95);
  EXPECT_LT(life.healths.back().health_trend_per_year, -5.0 * life.healths.back().health_trend_std_per_year);
}

TEST(Recordings, ResidualsOfAYearOfTheLife) {
  const std::filesystem::path folder = SEALWATCH_SHARED_DATA "/pst_life/xt03-mv2";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  const AssetConfig asset = asset_from("{asset_id: XT03-MV2, model: eha}");
  const Life life = play(asset, folder, {"2009", "2017-12"}, std::make_shared<ModelSimulator>());
  double nominal = 0.0;
  double own = 0.0;
  for (const ResidualSummary& residual : life.states.back().residuals) {
    EXPECT_GT(residual.nrmse_percent, residual.reference == Reference::own_baseline ? 90.0 : 40.0) << residual.channel;
    if (residual.channel != "position") continue;
    (residual.reference == Reference::own_baseline ? own : nominal) = residual.noise_normalised_rms;
  }
  EXPECT_LT(own, 0.1 * nominal);  // what eight years changed is the seal
  for (const StateReport& state : life.states) EXPECT_EQ(state.region, AlertRegion::normal);
}

TEST(Recordings, BenchRunsPassWithoutDates) {
  const std::filesystem::path folder = SEALWATCH_SHARED_DATA "/bench_eha";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  const AssetConfig asset =
      asset_from("{asset_id: BENCH, model: eha_switched, pst: {start: 0, stroke: 0.0125, speed: 0.0125, hold: 4}}");
  const Life life = play(asset, folder, {"oct21"}, nullptr);
  ASSERT_EQ(life.healths.size(), 12U);
  for (std::size_t k = 0; k < 12; ++k) {
    EXPECT_EQ(life.states[k].verdict, PstVerdict::passed) << testing::PrintToString(life.states[k].verdict_reasons);
    EXPECT_FALSE(life.states[k].pst_overdue);
    EXPECT_TRUE(life.healths[k].admissible_for_prognosis);
    EXPECT_FALSE(life.healths[k].trend_known);
    EXPECT_GT(life.healths[k].no_fault_likelihood, 0.5);
  }
}

}  // namespace
}  // namespace sealwatch
