// The public recordings through acquisition and manipulation. Skipped where they are not there.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>

#include "services/common/recording/recording_file.hpp"
#include "services/data_acquisition/data_acquisition.hpp"
#include "services/data_acquisition/recording_blocks.hpp"
#include "services/data_manipulation/data_manipulation.hpp"

namespace sealwatch {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> recordings(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code error;
  for (fs::directory_iterator entry(fs::path(SEALWATCH_SHARED_DATA) / folder, error), end; !error && entry != end;
       entry.increment(error))
    if (entry->path().extension() == ".csv") files.push_back(entry->path().string());
  std::sort(files.begin(), files.end());
  return files;
}

struct Result {
  TestWindow window;
  TestFeatures features;
};

Recording read(const std::string& file, const std::string& model) {
  Recording recording = read_recording(file, *find_plant(model).value()).value();
  recording.asset_id = "ASSET";
  return recording;
}

Result conclude(const Recording& recording, const std::string& model) {
  AssetConfig asset;
  asset.asset_id = "ASSET";
  asset.model = model;
  DataAcquisition acquisition({asset});
  DataManipulation manipulation({asset});
  Conclusion last;
  for (const RawSamples& raw : blocks_of(recording))
    for (const Message& block : acquisition.receive(raw).outputs) last = completed(manipulation.receive(block));
  return {std::get<TestWindow>(last.outputs.at(0)), std::get<TestFeatures>(last.outputs.at(1))};
}

Result conclude(const std::string& file, const std::string& model) { return conclude(read(file, model), model); }

double feature(const TestFeatures& features, const std::string& name) {
  for (const Quantity& quantity : features.features)
    if (quantity.name == name) return quantity.value;
  return std::nan("");
}

std::vector<PhaseKind> kinds(const TestWindow& window) {
  std::vector<PhaseKind> result;
  for (const Phase& phase : window.phases) result.push_back(phase.kind);
  return result;
}

TEST(Recordings, NineYearsOfTestsAreClean) {
  const std::vector<std::string> files = recordings("pst_life/xt03-mv2");
  if (files.empty()) GTEST_SKIP() << "shared data not there";
  std::vector<double> leakage;
  for (const std::string& file : files) {
    const Result result = conclude(file, "eha");
    EXPECT_THAT(result.window.alignment, testing::IsEmpty()) << file << ": " << result.window.alignment[0].remark;
    for (const ChannelStatus& status : result.window.channel_status)
      EXPECT_THAT(status.state, testing::AnyOf(ChannelState::OK, ChannelState::NOT_USED)) << file << status.reason;
    if (file.ends_with("2010-11.csv")) {
      EXPECT_EQ(result.window.abort_reason, "cut after 7.4 s of about 31 s, in phase out");
      continue;
    }
    EXPECT_TRUE(result.window.complete) << file << ": " << result.window.abort_reason;
    using enum PhaseKind;
    EXPECT_THAT(kinds(result.window), testing::ElementsAre(rest, breakaway, out, hold, back, hold)) << file;
    EXPECT_NEAR(feature(result.features, "travel"), 0.016, 1e-4) << file;
    EXPECT_NEAR(feature(result.features, "speed_out"), 1.33e-3, 1e-5) << file;
    leakage.push_back(feature(result.features, "leakage_flow_out"));
  }
  ASSERT_EQ(leakage.size(), 104U);
  // The seal wears: the last year leaks several times what the first did.
  const double first_year = std::accumulate(leakage.begin(), leakage.begin() + 12, 0.0);
  const double last_year = std::accumulate(leakage.end() - 12, leakage.end(), 0.0);
  EXPECT_GT(last_year, 2.0 * first_year);
}

TEST(Recordings, ADelayOfTwoSamplesAndASwappedSignAreSeenInRealNoise) {
  const std::vector<std::string> files = recordings("pst_life/xt03-mv2");
  if (files.empty()) GTEST_SKIP() << "shared data not there";
  for (std::size_t i = 0; i < files.size(); i += 10) {
    for (const char* name : {"velocity", "flow", "position"}) {
      Recording recording = read(files[i], "eha");
      for (Series& channel : recording.samples.channels) {
        if (channel.name != name) continue;
        channel.values.insert(channel.values.begin(), 2, channel.values.front());  // the piston stands at first
        channel.values.resize(recording.samples.time_s.size());
        if (channel.name == "flow")
          for (double& value : channel.values) value = -value;
      }
      const TestWindow window = conclude(recording, "eha").window;
      if (!window.complete) continue;  // seven seconds do not tell 40 ms
      ASSERT_EQ(window.alignment.size(), 1U) << files[i] << " " << name;
      EXPECT_EQ(window.alignment[0].channel, name) << files[i];
      EXPECT_NEAR(window.alignment[0].time_offset_s, 0.040, 4.0 * window.alignment[0].time_offset_std_s) << name;
      EXPECT_EQ(window.alignment[0].sign_swapped, std::string(name) == "flow");
      EXPECT_TRUE(window.alignment[0].corrected);
    }
  }
}

TEST(Recordings, TheBenchsDoubleCyclesAreUnderstood) {
  const std::vector<std::string> files = recordings("bench_eha");
  if (files.empty()) GTEST_SKIP() << "shared data not there";
  for (const std::string& file : files) {
    const Result result = conclude(file, "eha_switched");
    using enum PhaseKind;
    EXPECT_THAT(kinds(result.window),
                testing::ElementsAre(rest, breakaway, out, hold, back, hold, breakaway, out, hold, back, hold))
        << file;
    EXPECT_TRUE(result.window.complete) << file << ": " << result.window.abort_reason;
    EXPECT_THAT(result.window.alignment, testing::IsEmpty()) << file << ": " << result.window.alignment[0].remark;
    for (const ChannelStatus& status : result.window.channel_status)
      EXPECT_EQ(status.state, ChannelState::OK) << file << ": " << status.channel << " " << status.reason;
    const double stroke_m = 0.0125 * (file[file.size() - 5] - '0');  // "..._stroke3.csv"
    EXPECT_NEAR(feature(result.features, "travel"), stroke_m, 2e-4) << file;
    EXPECT_NEAR(feature(result.features, "speed_out"), 0.0125, 0.0025) << file;  // short strokes overshoot their speed
    EXPECT_GT(feature(result.features, "hold_decay"), 0.0) << file;
    EXPECT_TRUE(std::isnan(feature(result.features, "leakage_flow"))) << "no flow is recorded";
  }
}

}  // namespace
}  // namespace sealwatch
