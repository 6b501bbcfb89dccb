#include "services/data_manipulation/data_manipulation.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "sealwatch/signal/features.hpp"
#include "services/data_manipulation/refused_tests.hpp"
#include "tests/unit/layers/contract.hpp"
#include "tests/unit/signal/synthetic_pst.hpp"

namespace sealwatch {
namespace {

using test::only;
using test::SyntheticPst;
using testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// No sensor lags: the synthetic test has none.
AssetConfig asset() {
  AssetConfig config;
  config.asset_id = "XT03-MV2";
  for (const char* channel : {"pressure_a", "pressure_b", "pressure_differential", "flow", "position", "velocity"})
    config.sensors[channel] = SensorSetting{};
  return config;
}

/// Blocks of a test as data acquisition makes them.
std::vector<SampleBlock> blocks_of(const TimeSeries& samples, const std::string& pst_id, std::size_t rows = 500) {
  std::vector<SampleBlock> blocks;
  for (std::size_t begin = 0; begin < samples.time_s.size(); begin += rows) {
    const auto first = static_cast<std::ptrdiff_t>(begin);
    const auto last = static_cast<std::ptrdiff_t>(std::min(begin + rows, samples.time_s.size()));
    SampleBlock block;
    block.asset_id = "XT03-MV2";
    block.block_number = blocks.size();
    block.header.pst_id = pst_id;
    block.header.message_id = "sample_block/" + pst_id + "/" + std::to_string(block.block_number);
    block.header.event_time_known = true;
    block.header.event_time_ns = 42;
    block.header.replay = true;
    block.test_kind = "pst";
    block.boundary = begin == 0 ? BlockBoundary::begin : BlockBoundary::inside;
    block.samples.time_s = {samples.time_s.begin() + first, samples.time_s.begin() + last};
    for (const Series& channel : samples.channels) {
      block.samples.channels.push_back(
          {channel.name, channel.unit, 0.0, {channel.values.begin() + first, channel.values.begin() + last}});
      block.channel_status.push_back({channel.name, ChannelState::OK, ""});
    }
    blocks.push_back(std::move(block));
  }
  blocks.back().boundary = blocks.size() == 1 ? BlockBoundary::whole : BlockBoundary::end;
  return blocks;
}

struct Result {
  TestWindow window;
  TestFeatures features;
};

Result conclude(const std::vector<SampleBlock>& blocks, const AssetConfig& config = asset()) {
  DataManipulation layer({config});
  Conclusion conclusion;
  for (const SampleBlock& block : blocks) {
    EXPECT_TRUE(conclusion.outputs.empty()) << "concluded before the end";
    EXPECT_TRUE(conclusion.consumed.empty());
    conclusion = completed(layer.receive(block));
  }
  EXPECT_EQ(conclusion.consumed.size(), blocks.size());
  EXPECT_EQ(conclusion.outputs.size(), 2U);
  return {std::get<TestWindow>(conclusion.outputs.at(0)), std::get<TestFeatures>(conclusion.outputs.at(1))};
}
Result conclude(const TimeSeries& samples) { return conclude(blocks_of(samples, "ID")); }

std::optional<Quantity> find(const TestFeatures& features, const std::string& name) {
  for (const Quantity& feature : features.features)
    if (feature.name == name) return feature;
  return std::nullopt;
}

std::vector<double>& values(TimeSeries& samples, const std::string& channel) {
  for (Series& series : samples.channels)
    if (series.name == channel) return series.values;
  throw std::logic_error("no channel " + channel);
}

TEST(DataManipulation, TestsWhoseEndNeverComesTakeNoMoreMemoryThanTwo) {
  DataManipulation layer({asset()});
  const auto real = blocks_of(SyntheticPst{}.record(), "REAL");
  ASSERT_GT(real.size(), 1U);
  std::size_t open = 0, halfway = 0;
  for (int k = 0; k < 100'000; ++k) {
    const Conclusion conclusion = layer.receive(test::forged(real.front(), k));
    open += 1 - conclusion.consumed.size();
    if (k == 50'000) halfway = ::mallinfo2().uordblks;
  }
  EXPECT_LE(open, 256U);
  EXPECT_LT(::mallinfo2().uordblks, halfway + 1'000'000);
  Conclusion endless;
  for (int k = 0; k < 300'000; ++k) {
    SampleBlock empty;
    empty.asset_id = "XT03-MV2";
    empty.header.pst_id = "endless";
    empty.header.message_id = "sample_block/endless/" + std::to_string(k);
    open += 1;
    open -= layer.receive(empty).consumed.size();
  }
  EXPECT_LE(open, 250'000U);
  for (const SampleBlock& block : real) endless = completed(layer.receive(block));
  EXPECT_EQ(endless.consumed.size(), real.size());
  EXPECT_EQ(endless.outputs.size(), 2U);
}

TEST(DataManipulation, ARecordingThatBeginsInsideTheStrokeIsNotComplete) {
  TimeSeries late = SyntheticPst{}.record();
  constexpr std::ptrdiff_t kDropped = 800;  // 4 s
  late.time_s.erase(late.time_s.begin(), late.time_s.begin() + kDropped);
  for (Series& channel : late.channels) channel.values.erase(channel.values.begin(), channel.values.begin() + kDropped);
  const Result result = conclude(late);
  EXPECT_FALSE(result.features.complete);
  EXPECT_EQ(result.features.abort_reason, "the recording begins inside the stroke");
  std::vector<SampleBlock> other = blocks_of(late, "ID");
  for (SampleBlock& block : other) block.test_kind = "other";
  EXPECT_TRUE(conclude(other).features.complete) << "no stroke test";
}

TEST(DataManipulation, ConcludesOnceFromAllBlocks) {
  const SyntheticPst pst;
  const TimeSeries recorded = pst.record();
  const Result result = conclude(recorded);
  EXPECT_EQ(result.window.header.message_id, "test_window/ID");
  EXPECT_EQ(result.features.header.message_id, "test_features/ID");
  EXPECT_EQ(result.window.header.source_ids.size(), 13U);
  EXPECT_THAT(result.features.header.source_ids, testing::ElementsAre("test_window/ID"));
  EXPECT_EQ(result.window.header.event_time_ns, 42);
  EXPECT_TRUE(result.window.header.replay);
  EXPECT_TRUE(result.window.complete) << result.window.abort_reason;
  EXPECT_THAT(result.window.samples.time_s, testing::Pointwise(testing::DoubleNear(1e-9), recorded.time_s));
  for (const Series& channel : recorded.channels)
    EXPECT_EQ(result.window.samples.find(channel.name)->values, channel.values) << channel.name;
  EXPECT_NEAR(result.window.sample_rate_Hz, 200.0, 1e-9);
  EXPECT_EQ(result.window.missing_share, 0.0);
  EXPECT_THAT(result.window.alignment, testing::IsEmpty());
  EXPECT_THAT(result.window.filter, HasSubstr("zero phase"));
  EXPECT_EQ(result.window.phases.size(), 6U);
  for (const Quantity& feature : result.features.features) {
    const auto* described = signal::find_feature(feature.name);
    ASSERT_NE(described, nullptr);
    EXPECT_EQ(feature.unit, described->unit);
    EXPECT_TRUE(feature.std_error_known);
  }
  const auto leakage = find(result.features, "leakage_flow");
  ASSERT_TRUE(leakage);
  EXPECT_NEAR(leakage->value, pst.load_N / pst.area_m2 / pst.resistance_Pa_s_m3, 4.0 * leakage->std_error);
}

TEST(DataManipulation, EstimatesNoiseWhereTheRecordingGivesNone) {
  const Result result = conclude(SyntheticPst{}.record());
  const std::pair<const char*, double> expected[] = {{"pressure_a", 1e4}, {"flow", 4e-8}, {"position", 5e-6}};
  for (const auto& [channel, noise_std] : expected)  // the median of 6200 differences is known to some 2 %
    EXPECT_NEAR(result.window.samples.find(channel)->noise_std, noise_std, 0.1 * noise_std) << channel;
  std::vector<SampleBlock> blocks = blocks_of(SyntheticPst{}.record(), "ID");
  for (SampleBlock& block : blocks) block.samples.channels[5].noise_std = 7e-8;
  EXPECT_EQ(conclude(blocks).window.samples.channels[5].noise_std, 7e-8);
}

TEST(DataManipulation, SortsBlocksAndFillsGaps) {
  const TimeSeries recorded = SyntheticPst{}.record();
  std::vector<SampleBlock> blocks = blocks_of(recorded, "ID");
  std::swap(blocks[3], blocks[7]);
  EXPECT_EQ(conclude(blocks).window.samples, conclude(recorded).window.samples);
  blocks.erase(blocks.begin() + 5);  // 2.5 s
  const Result gap = conclude(blocks);
  EXPECT_NEAR(gap.window.missing_share, 500.0 / 6201.0, 1e-9);
  EXPECT_EQ(gap.window.samples.time_s.size(), 6201U);
  EXPECT_TRUE(gap.window.complete);
}

TEST(DataManipulation, ResamplesAJitteredRecording) {
  const SyntheticPst pst{.noise = 0.0};
  TimeSeries recorded = pst.record();
  std::mt19937 generator(4);
  std::uniform_real_distribution<double> jitter(-0.001, 0.001);
  for (std::size_t i = 1; i < recorded.time_s.size(); ++i) {
    recorded.time_s[i] += jitter(generator);
    values(recorded, "position")[i] = pst.position(recorded.time_s[i]);
  }
  const Result result = conclude(only(recorded, {"position"}));
  EXPECT_NEAR(result.window.sample_rate_Hz, 200.0, 0.01);
  EXPECT_NEAR(result.window.jitter_std_s, 0.001 * std::sqrt(2.0 / 3.0), 1e-4);
  const TimeSeries& window = result.window.samples;
  for (std::size_t i = 0; i < window.time_s.size(); ++i)
    ASSERT_NEAR(window.channels[0].values[i], pst.position(window.time_s[i]), 2e-7) << i;
}

TEST(DataManipulation, InterpolatesWhatIsNotANumberAndLeavesOutFailedChannels) {
  TimeSeries recorded = SyntheticPst{}.record();
  values(recorded, "flow")[1000] = kNaN;
  std::vector<SampleBlock> blocks = blocks_of(recorded, "ID");
  for (SampleBlock& block : blocks) block.channel_status[3] = {"pressure_a", ChannelState::FAILED, "frozen"};
  const Result result = conclude(blocks);
  EXPECT_FALSE(result.window.samples.has("pressure_a"));
  EXPECT_FALSE(find(result.features, "rest_pressure"));
  EXPECT_EQ(result.window.channel_status[3].reason, "frozen");
  EXPECT_TRUE(std::isfinite(result.window.samples.find("flow")->values[1000]));
  EXPECT_NEAR(result.window.missing_share, 1.0 / (6201.0 * 7.0), 1e-12);
}

TEST(DataManipulation, ACutTestIsNotComplete) {
  const Result cut = conclude(SyntheticPst{.duration_s = 7.4}.record());
  EXPECT_FALSE(cut.window.complete);
  EXPECT_FALSE(cut.features.complete);
  EXPECT_EQ(cut.window.abort_reason, "cut after 7.4 s of about 31 s, in phase out");

  std::vector<SampleBlock> blocks = blocks_of(SyntheticPst{}.record(), "ID");
  blocks.back().aborted = true;
  blocks.back().abort_reason = "MCS command had priority";
  const Result aborted = conclude(blocks);
  EXPECT_TRUE(aborted.features.aborted);
  EXPECT_FALSE(aborted.features.complete);
  EXPECT_EQ(aborted.features.abort_reason, "MCS command had priority");

  blocks = blocks_of(SyntheticPst{}.record(), "ID");
  blocks.erase(blocks.begin());
  EXPECT_EQ(conclude(blocks).window.abort_reason, "the begin of the test was not recorded");
}

TEST(DataManipulation, NothingUsableIsSaidNotInvented) {
  SampleBlock empty;
  empty.asset_id = "XT03-MV2";
  empty.header.message_id = "sample_block/ID/0";
  empty.header.pst_id = "ID";
  empty.boundary = BlockBoundary::whole;
  const Result nothing = conclude(std::vector<SampleBlock>{empty});
  EXPECT_FALSE(nothing.window.complete);
  EXPECT_EQ(nothing.window.abort_reason, "no sample was recorded");
  EXPECT_TRUE(nothing.features.features.empty());

  TimeSeries far = SyntheticPst{}.record();
  far.time_s.back() = 1e12;
  const Result gap = conclude(far);
  EXPECT_THAT(gap.window.abort_reason, HasSubstr("nothing was recorded for"));
  EXPECT_EQ(gap.window.samples.time_s.size(), 6200U);
}

TEST(DataManipulation, AnUnknownAssetStillGetsItsWindow) {
  std::vector<SampleBlock> blocks = blocks_of(SyntheticPst{}.record(), "ID");
  for (SampleBlock& block : blocks) block.asset_id = "NOBODY";
  const Result result = conclude(blocks);
  EXPECT_EQ(result.window.phases.size(), 6U);
  EXPECT_TRUE(find(result.features, "travel"));
  EXPECT_FALSE(find(result.features, "leakage_flow")) << "the piston's area is not known";
}

const AlignmentRemark* remark_on(const Result& result, const std::string& channel) {
  for (const AlignmentRemark& remark : result.window.alignment)
    if (remark.channel == channel) return &remark;
  return nullptr;
}

TEST(Alignment, ALateChannelIsFoundAndCorrected) {
  for (const double late_s : {0.120, -0.080}) {
    for (const char* channel : {"velocity", "flow", "position"}) {
      const SyntheticPst right;
      const Result result = conclude(SyntheticPst{.late_s = {{channel, late_s}}}.record());
      ASSERT_EQ(result.window.alignment.size(), 1U) << channel;
      const AlignmentRemark* remark = remark_on(result, channel);
      ASSERT_NE(remark, nullptr) << channel << " was late, " << result.window.alignment[0].channel << " was blamed";
      EXPECT_TRUE(remark->corrected);
      EXPECT_FALSE(remark->sign_swapped);
      EXPECT_NEAR(remark->time_offset_s, late_s, 4.0 * remark->time_offset_std_s + 0.005) << channel;  // one sample
      EXPECT_EQ(
          result.window.samples.time_s.size(),
          right.record().time_s.size() - static_cast<std::size_t>(std::ceil(std::abs(remark->time_offset_s) * 200.0)));
      const auto index = static_cast<std::size_t>(std::lround((1.6 - result.window.samples.time_s.front()) * 200.0));
      const double time_s = result.window.samples.time_s[index];  // at full speed of the stroke out
      if (std::string(channel) == "position") {
        EXPECT_NEAR(result.window.samples.find(channel)->values[index], right.position(time_s), 4e-5);
      }
    }
  }
}

TEST(Alignment, ASwappedSignIsFoundAndCorrected) {
  for (const char* channel : {"velocity", "flow", "shaft_speed", "position"}) {
    const TimeSeries recorded = SyntheticPst{.sign = {{channel, -1.0}}}.record();
    const Result result = conclude(recorded);
    ASSERT_EQ(result.window.alignment.size(), 1U) << channel;
    const AlignmentRemark* remark = remark_on(result, channel);
    ASSERT_NE(remark, nullptr) << channel;
    EXPECT_TRUE(remark->sign_swapped);
    EXPECT_TRUE(remark->corrected);
    EXPECT_EQ(result.window.samples.find(channel)->values[2000], -recorded.find(channel)->values[2000]) << channel;
  }
}

TEST(Alignment, TwoChannelsAloneAreNamedAndLeftAlone) {
  const Result swapped = conclude(only(SyntheticPst{.sign = {{"velocity", -1.0}}}.record(), {"position", "velocity"}));
  ASSERT_NE(remark_on(swapped, "velocity"), nullptr);
  EXPECT_TRUE(remark_on(swapped, "velocity")->sign_swapped);
  EXPECT_FALSE(remark_on(swapped, "velocity")->corrected);
  EXPECT_THAT(remark_on(swapped, "velocity")->remark, HasSubstr("it is unknown which"));
  const Result late =
      conclude(only(SyntheticPst{.late_s = {{"flow", 0.2}}}.record(), {"position", "flow", "pressure_a"}));
  ASSERT_NE(remark_on(late, "flow"), nullptr);
  EXPECT_NEAR(remark_on(late, "flow")->time_offset_s, 0.2, 0.005);
  EXPECT_FALSE(remark_on(late, "flow")->corrected);
}

TEST(Alignment, TheDifferentialPressureIsHeldAgainstBothPressures) {
  TimeSeries recorded = SyntheticPst{}.record();
  Series differential{"pressure_differential", "Pa", 0.0, values(recorded, "pressure_b")};
  for (std::size_t i = 0; i < differential.values.size(); ++i)
    differential.values[i] -= values(recorded, "pressure_a")[i];
  recorded.channels.push_back(differential);
  const Result result = conclude(recorded);
  ASSERT_NE(remark_on(result, "pressure_differential"), nullptr);
  EXPECT_TRUE(remark_on(result, "pressure_differential")->sign_swapped);
  EXPECT_GT(result.window.samples.find("pressure_differential")->values[100], 1e7);
}

// The source's own channels: the leakage flow while the piston stands tells the difference's sign, or that its own zero
// is off, so that nothing is corrected.
TEST(Alignment, APressureDifferenceAgainstTheLeakageFlowIsNoticed) {
  TimeSeries recorded = SyntheticPst{}.record();
  for (const double sign : {1.0, -1.0}) {
    TimeSeries few = only(recorded, {"flow", "position", "velocity"});
    Series differential{"pressure_differential", "Pa", 0.0, values(recorded, "pressure_a")};
    for (std::size_t i = 0; i < differential.values.size(); ++i)
      differential.values[i] = sign * (differential.values[i] - values(recorded, "pressure_b")[i]);
    few.channels.push_back(differential);
    const Result result = conclude(few);
    const AlignmentRemark* remark = remark_on(result, "pressure_differential");
    if (sign > 0.0) {
      EXPECT_TRUE(remark == nullptr || !remark->sign_swapped);
      continue;
    }
    ASSERT_NE(remark, nullptr);
    EXPECT_TRUE(remark->sign_swapped);
    EXPECT_FALSE(remark->corrected);
    EXPECT_THAT(remark->remark, HasSubstr("leaks while the piston stands"));
  }
}

TEST(Alignment, SensorLagsThatTheAssetKnowsAreNoOffsets) {
  TimeSeries recorded = SyntheticPst{.noise = 0.0}.record();
  std::vector<double>& flow = values(recorded, "flow");
  flow = signal::first_order_lag(flow, 0.05, 0.005);
  std::mt19937 generator(3);
  std::normal_distribution<double> normal(0.0, 4e-8);
  for (double& value : flow) value += normal(generator);
  for (double& value : values(recorded, "position")) value += 125.0 * normal(generator);
  AssetConfig known = asset();
  known.sensors["flow"].time_constant_s = 0.05;
  EXPECT_THAT(conclude(blocks_of(recorded, "ID"), known).window.alignment, testing::IsEmpty());
  EXPECT_NE(remark_on(conclude(recorded), "flow"), nullptr) << "a lag that nobody told of looks like an offset";
}

TEST(Alignment, RaisesNoFalseAlarms) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const double rate_Hz = seed % 2 == 0 ? 50.0 : 200.0;
    const double resistance = seed % 3 == 0 ? 4.64e12 : 2.6e13;
    const Result result = conclude(
        SyntheticPst{.rate_Hz = rate_Hz, .noise = 2.0, .seed = seed, .resistance_Pa_s_m3 = resistance}.record());
    EXPECT_THAT(result.window.alignment, testing::IsEmpty()) << "seed " << seed;
  }
}

TEST(DataManipulation, ComesBackFromItsOwnOutputsAtAnyPoint) {
  std::vector<Message> inputs;
  for (unsigned seed = 1; seed <= 3; ++seed)
    for (const SampleBlock& block :
         blocks_of(SyntheticPst{.rate_Hz = 50.0, .seed = seed}.record(), std::to_string(seed), 300))
      inputs.emplace_back(block);
  std::mt19937 generator(9);
  std::shuffle(inputs.begin(), inputs.end(), generator);  // late blocks and interleaved tests
  test::expect_restartable([] { return std::make_unique<DataManipulation>(std::vector<AssetConfig>{asset()}); },
                           inputs);
}

TEST(DataManipulationOptions, NamesWhatIsWrong) {
  EXPECT_TRUE(DataManipulationOptions{}.validate());
  DataManipulationOptions options;
  options.least_correlation = 1.5;
  ASSERT_FALSE(options.validate());
  EXPECT_EQ(options.validate().error().place, "least_correlation");
}

TimeSeries at_times(std::vector<double> time_s) {
  TimeSeries samples{.time_s = std::move(time_s), .channels = {{"position", "m", 0.0, {}}, {"flow", "m3/s", 0.0, {}}}};
  for (const double t : samples.time_s) {
    samples.channels[0].values.push_back(0.06 - 1e-3 * t);
    samples.channels[1].values.push_back(1e-6);
  }
  return samples;
}

/// Stamped on arrival: fifty rows a microsecond apart, once a second. A uniform window of them would have a million
/// rows a second.
TEST(DataManipulation, RowsThatComeInBurstsAreKeptAndRefusedByName) {
  std::vector<double> time_s;
  for (int second = 0; second < 60; ++second)
    for (int row = 0; row < 50; ++row) time_s.push_back(second + 1e-6 * row);
  const Result result = conclude(at_times(time_s));
  EXPECT_FALSE(result.window.complete);
  EXPECT_TRUE(result.window.samples.time_s.empty());
  EXPECT_THAT(result.window.abort_reason, HasSubstr("refused: rows 1e-06 s apart"));
  EXPECT_EQ(result.features.abort_reason, result.window.abort_reason);
  EXPECT_EQ(result.window.header.source_ids.size(), 6U) << "its blocks are known";
}

TEST(DataManipulation, ATestBeyondALimitIsRefusedByName) {
  std::vector<double> picoseconds, few_of_many;
  for (int row = 0; row < 1000; ++row) {
    picoseconds.push_back(5e-12 * row);
    few_of_many.push_back(row % 20 == 0 ? 4.0 * (row / 20) : few_of_many.back() + 0.001);
  }
  EXPECT_THAT(conclude(at_times(picoseconds)).window.abort_reason,
              HasSubstr("refused: rows 5e-12 s apart, closer than the 1e-05 s"));
  EXPECT_THAT(conclude(at_times(few_of_many)).window.abort_reason, HasSubstr("rows would stand for the 1000 recorded"));
}

/// Nobody looks for a test of which nothing is concluded: it is kept, and told of by name until one can be used.
TEST(DataManipulation, ALiveTestThatIsRefusedIsAnAlarmUntilALaterOneIsTaken) {
  RefusedTests refused;
  std::vector<double> picoseconds, seconds;
  for (int row = 0; row < 1000; ++row) {
    picoseconds.push_back(5e-12 * row);
    seconds.push_back(0.05 * row);
  }
  const auto alarms_after = [&](const std::vector<double>& time_s, int day, bool is_replay) {
    auto blocks = blocks_of(at_times(time_s), "ID-" + std::to_string(day));
    for (SampleBlock& block : blocks) {
      block.header.replay = is_replay;
      block.header.event_time_ns = day;
      block.recording_id = "april-" + std::to_string(day);
    }
    return refused.look(conclude(blocks).features);
  };
  const auto standing = alarms_after(picoseconds, 2, false);
  ASSERT_TRUE(standing);
  ASSERT_EQ(standing->standing.size(), 1U);
  EXPECT_EQ(standing->standing[0].kind, "refused_test");
  EXPECT_EQ(standing->standing[0].asset_id, "XT03-MV2");
  EXPECT_EQ(standing->standing[0].pst_id, "ID-2");
  EXPECT_THAT(standing->standing[0].text,
              HasSubstr("recording april-2 is refused: rows 5e-12 s apart, closer than the 1e-05 s"));
  EXPECT_FALSE(alarms_after(seconds, 1, false)) << "an older one says nothing";
  EXPECT_FALSE(alarms_after(seconds, 3, true)) << "played back, it says nothing";
  const auto later = alarms_after(seconds, 4, false);
  ASSERT_TRUE(later);
  EXPECT_TRUE(later->standing.empty());
}

}  // namespace
}  // namespace sealwatch
