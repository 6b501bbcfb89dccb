#include "services/data_acquisition/data_acquisition.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "services/data_acquisition/recording_blocks.hpp"
#include "tests/unit/layers/contract.hpp"
#include "tests/unit/signal/synthetic_pst.hpp"

namespace sealwatch {
namespace {

using test::SyntheticPst;
using testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

AssetConfig asset(const std::string& id) {
  AssetConfig config;
  config.asset_id = id;
  return config;
}

std::vector<AssetConfig> assets() { return {asset("XT03-MV2"), asset("XT04-MV1")}; }

Recording recording(unsigned seed = 1, const std::string& asset_id = "XT03-MV2") {
  Recording result;
  result.recording_id = "2031-04-PST-" + std::to_string(seed);
  result.asset_id = asset_id;
  result.start_time = parse_utc("2031-04-12T03:00:00Z").value();
  result.start_time = add_months(*result.start_time, seed);
  result.content_hash = "1a2b3c4d5e6f708" + std::to_string(seed % 10);
  result.samples = SyntheticPst{.rate_Hz = 50.0, .seed = seed}.record();
  return result;
}

/// Sends raw blocks and returns the sample blocks.
std::vector<SampleBlock> send(DataAcquisition& layer, const std::vector<RawSamples>& raw) {
  std::vector<SampleBlock> result;
  for (const RawSamples& block : raw) {
    const Conclusion conclusion = layer.receive(block);
    EXPECT_THAT(conclusion.consumed, testing::ElementsAre(block.header.message_id));
    for (const Message& output : conclusion.outputs) result.push_back(std::get<SampleBlock>(output));
  }
  return result;
}

/// As an actuator sends them whose test is under way.
std::vector<RawSamples> live_blocks_of(const Recording& test) {
  std::vector<RawSamples> blocks = blocks_of(test);
  for (RawSamples& block : blocks) block.header.replay = false;
  return blocks;
}

std::vector<SampleBlock> send_all(const Recording& test) {
  DataAcquisition layer(assets());
  return send(layer, blocks_of(test));
}

ChannelStatus final_status(const std::vector<SampleBlock>& blocks, const std::string& channel) {
  for (const ChannelStatus& status : blocks.back().channel_status)
    if (status.channel == channel) return status;
  return {channel, ChannelState::UNKNOWN, "no such channel in the status"};
}

std::vector<double>& values(Recording& test, const std::string& channel) {
  for (Series& series : test.samples.channels)
    if (series.name == channel) return series.values;
  throw std::logic_error("no channel " + channel);
}

TEST(PstId, NamesAssetStartAndContent) {
  Recording test = recording();
  test.start_time = parse_utc("2031-04-12T03:00:00Z").value();
  EXPECT_EQ(send_all(test).front().header.pst_id, "XT03-MV2-20310412T030000Z-1a2b3c4d");
  test.start_time.reset();
  const std::vector<SampleBlock> undated = send_all(test);
  EXPECT_EQ(undated.front().header.pst_id, "XT03-MV2-2031-04-PST-1-1a2b3c4d");
  EXPECT_FALSE(undated.front().header.event_time_known);
}

/// The acts about it name it with its asset, up to three times, and no id may be longer than 500 bytes.
TEST(PstId, OfARecordingWithALongNameIsNotLonger) {
  Recording test = recording();
  test.start_time.reset();
  test.recording_id = std::string(490, 'r');
  const std::string id = send_all(test).front().header.pst_id;
  EXPECT_LT(id.size(), 60U) << id;
  test.recording_id += "s";
  EXPECT_NE(send_all(test).front().header.pst_id, id);
}

TEST(PstId, OfAForeignSenderComesFromTheFirstBlocksContent) {
  Recording test = recording();
  test.start_time.reset();
  test.recording_id = test.content_hash = "";
  const std::string id = send_all(test).front().header.pst_id;
  EXPECT_THAT(id, testing::StartsWith("XT03-MV2-undated-"));
  EXPECT_EQ(send_all(test).back().header.pst_id, id);
  values(test, "flow").front() += 1e-9;
  EXPECT_NE(send_all(test).front().header.pst_id, id);
}

TEST(DataAcquisition, PassesACleanTestOnBlockByBlock) {
  const Recording test = recording();
  const std::vector<SampleBlock> blocks = send_all(test);
  ASSERT_EQ(blocks.size(), 8U);  // 1551 rows by 200
  EXPECT_EQ(blocks.front().boundary, BlockBoundary::begin);
  EXPECT_EQ(blocks.back().boundary, BlockBoundary::end);
  TimeSeries together;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    EXPECT_EQ(blocks[i].header.message_id,
              "sample_block/" + blocks[0].header.pst_id + "/" + std::to_string(blocks[i].block_number));
    EXPECT_EQ(blocks[i].block_number, i);
    EXPECT_EQ(blocks[i].header.event_time_ns, test.start_time->nanoseconds);
    EXPECT_TRUE(blocks[i].header.replay);
    const std::vector<double>& time_s = blocks[i].samples.time_s;
    together.time_s.insert(together.time_s.end(), time_s.begin(), time_s.end());
  }
  EXPECT_EQ(together.time_s, test.samples.time_s);
  EXPECT_EQ(blocks.back().dropped_samples, 0U);
  for (const char* channel : {"pressure_a", "flow", "position", "velocity", "motor_voltage", "shaft_speed"})
    EXPECT_EQ(final_status(blocks, channel).state, ChannelState::OK) << final_status(blocks, channel).reason;
  EXPECT_EQ(final_status(blocks, "fluid_temperature").state, ChannelState::NOT_USED);
}

TEST(DataAcquisition, WhatComesTwiceChangesNothing) {
  DataAcquisition layer(assets());
  const std::vector<RawSamples> first = blocks_of(recording(1));
  const std::vector<RawSamples> second = blocks_of(recording(2));
  EXPECT_EQ(send(layer, {first.begin(), first.begin() + 3}).size(), 3U);
  EXPECT_EQ(send(layer, first).size(), first.size() - 3) << "a sender that starts again is followed from where it was";
  EXPECT_TRUE(send(layer, first).empty());
  EXPECT_EQ(send(layer, {second.begin(), second.begin() + 2}).size(), 2U);
  EXPECT_TRUE(send(layer, first).empty()) << "an old test does not close the open one";
  EXPECT_EQ(send(layer, second).size(), second.size() - 2);
}

TEST(DataAcquisition, ANewTestClosesTheOpenOneAsCut) {
  DataAcquisition layer(assets());
  const std::vector<RawSamples> first = live_blocks_of(recording(1));
  const std::vector<RawSamples> second = live_blocks_of(recording(2));
  const std::vector<RawSamples> other = live_blocks_of(recording(1, "XT04-MV1"));
  send(layer, {first.begin(), first.begin() + 3});
  send(layer, {other.begin(), other.begin() + 1});
  const std::vector<SampleBlock> blocks = send(layer, {second.begin(), second.begin() + 1});
  ASSERT_EQ(blocks.size(), 2U);
  EXPECT_EQ(blocks[0].asset_id, "XT03-MV2");
  EXPECT_EQ(blocks[0].boundary, BlockBoundary::end);
  EXPECT_EQ(blocks[0].block_number, 3U);
  EXPECT_TRUE(blocks[0].aborted);
  EXPECT_THAT(blocks[0].abort_reason, HasSubstr("another test began"));
  EXPECT_TRUE(blocks[0].samples.time_s.empty());
  EXPECT_EQ(blocks[1].boundary, BlockBoundary::begin);
  EXPECT_EQ(send(layer, {other.begin() + 1, other.end()}).size(), other.size() - 1) << "other assets go on";
}

/// The block that closes it bore number 0, and was taken for the first block, come again: the test never ended.
TEST(DataAcquisition, ATestWithTheHighestBlockNumberIsClosedAsAnyOther) {
  DataAcquisition layer(assets());
  std::vector<RawSamples> blocks = live_blocks_of(recording(1));
  blocks.resize(3);
  blocks.back().block_number = std::numeric_limits<std::uint64_t>::max();
  std::set<std::string> ids;
  for (const SampleBlock& block : send(layer, blocks)) ids.insert(block.header.message_id);
  const std::vector<SampleBlock> later = send(layer, live_blocks_of(recording(2)));
  ASSERT_GE(later.size(), 2U);
  EXPECT_EQ(later.front().boundary, BlockBoundary::end);
  EXPECT_TRUE(later.front().aborted);
  EXPECT_FALSE(ids.contains(later.front().header.message_id)) << later.front().header.message_id;
}

TEST(DataAcquisition, ATestThatFallsSilentIsClosedByTime) {
  DataAcquisition layer(assets());
  const std::vector<RawSamples> raw = live_blocks_of(recording());
  UtcTime now{1'000'000'000};
  EXPECT_TRUE(layer.tick(now).outputs.empty());
  const auto pass = [&](int seconds) {
    Conclusion conclusion;
    for (int k = 0; k < seconds && conclusion.outputs.empty(); ++k)
      conclusion = layer.tick(now = add_seconds(now, 1.0));
    return conclusion;
  };
  send(layer, {raw.begin(), raw.begin() + 3});
  EXPECT_TRUE(pass(59).outputs.empty());
  send(layer, {raw[3]});  // it lives
  EXPECT_TRUE(pass(2).outputs.empty());
  const Conclusion conclusion = pass(60);
  ASSERT_EQ(conclusion.outputs.size(), 1U);
  const auto& block = std::get<SampleBlock>(conclusion.outputs[0]);
  EXPECT_EQ(block.abort_reason, "cut: no samples for 60 s");
  EXPECT_EQ(block.boundary, BlockBoundary::end);
  EXPECT_TRUE(send(layer, {raw.begin() + 4, raw.end()}).empty()) << "what comes later is too late";
  EXPECT_TRUE(layer.tick(add_seconds(now, 1000.0)).outputs.empty());
}

TEST(DataAcquisition, AClockThatIsSetEndsNoTest) {
  for (const double step_s : {3600.0, -3600.0}) {
    DataAcquisition layer(assets());
    const std::vector<RawSamples> raw = live_blocks_of(recording());
    UtcTime now{1'000'000'000};
    (void)layer.tick(now);
    send(layer, {raw.begin(), raw.begin() + 3});
    EXPECT_TRUE(layer.tick(now = add_seconds(now, 1.0)).outputs.empty());
    EXPECT_TRUE(layer.tick(now = add_seconds(now, step_s)).outputs.empty()) << step_s;
    EXPECT_EQ(send(layer, {raw.begin() + 3, raw.end()}).size(), raw.size() - 3);
  }
}

// Two engineers may replay at once, and beside a live test; one who stopped may go on.
TEST(DataAcquisition, ARecordingThatIsPlayedBackCutsNothingAndIsNotCut) {
  DataAcquisition layer(assets());
  const std::vector<RawSamples> live = live_blocks_of(recording(1));
  const std::vector<RawSamples> one = blocks_of(recording(2));
  const std::vector<RawSamples> other = blocks_of(recording(3));
  std::vector<RawSamples> mixed;
  for (std::size_t k = 0; k < live.size(); ++k)
    for (const auto* blocks : {&one, &live, &other})
      if (k < blocks->size()) mixed.push_back((*blocks)[k]);
  mixed.pop_back();  // its player was stopped
  const std::vector<SampleBlock> blocks = send(layer, mixed);
  EXPECT_EQ(blocks.size(), mixed.size());
  for (const SampleBlock& block : blocks) EXPECT_FALSE(block.aborted) << block.header.message_id;
  UtcTime now{1'000'000'000};
  for (int k = 0; k < 100; ++k) EXPECT_TRUE(layer.tick(now = add_seconds(now, 1.0)).outputs.empty());
  const std::vector<SampleBlock> again = send(layer, other);
  ASSERT_EQ(again.size(), 1U) << "only what it missed";
  EXPECT_EQ(again.front().boundary, BlockBoundary::end);
}

/// Sends the first three blocks of a live test, then `between`, then the rest: how the live test ended.
SampleBlock end_of_live_test_beside(const std::vector<RawSamples>& between) {
  DataAcquisition layer(assets());
  const std::vector<RawSamples> live = live_blocks_of(recording(5));
  std::vector<SampleBlock> blocks = send(layer, {live.begin(), live.begin() + 3});
  const std::string pst_id = blocks.front().header.pst_id;
  for (const auto& more : {between, std::vector<RawSamples>{live.begin() + 3, live.end()}})
    for (SampleBlock& block : send(layer, more))
      if (block.header.pst_id == pst_id) blocks.push_back(std::move(block));
  EXPECT_EQ(blocks.size(), live.size());
  return blocks.back();
}

TEST(DataAcquisition, OnlyItsOwnSendersNextTestCutsALiveOne) {
  std::vector<RawSamples> dropped = blocks_of(recording(2), kSamplesPerBlock, kFolderSource, false);
  std::vector<RawSamples> sent_late = live_blocks_of(recording(2));
  RawSamples stray;
  stray.asset_id = "XT03-MV2";
  stray.source_id = "stranger";
  stray.header.message_id = "stray";
  stray.block_number = 5;
  stray.samples.time_s = {1.0};
  std::vector<RawSamples> of_another = live_blocks_of(recording(6));
  for (RawSamples& block : of_another) block.source_id = "another";
  for (const auto& between : {dropped, sent_late, std::vector<RawSamples>{stray}, of_another}) {
    const SampleBlock end = end_of_live_test_beside(between);
    EXPECT_FALSE(end.aborted) << between.front().source_id << ": " << end.abort_reason;
    EXPECT_EQ(end.boundary, BlockBoundary::end);
  }
}

/// Its rest is read again at the next start, after other files it may be.
TEST(DataAcquisition, ARecordingOfTheFolderIsNotCutByTime) {
  DataAcquisition layer(assets());
  const std::vector<RawSamples> dropped = blocks_of(recording(2), kSamplesPerBlock, kFolderSource, false);
  send(layer, {dropped.begin(), dropped.begin() + 2});
  UtcTime now{1'000'000'000};
  for (int k = 0; k < 100; ++k) EXPECT_TRUE(layer.tick(now = add_seconds(now, 1.0)).outputs.empty());
  send(layer, blocks_of(recording(3), kSamplesPerBlock, kFolderSource, false));
  EXPECT_EQ(send(layer, dropped).size(), dropped.size() - 2);
  EXPECT_TRUE(layer.is_closed(dropped.front()));
}

TEST(DataAcquisition, ATestWhoseBeginWasMissedIsTakenFromWhereItIs) {
  DataAcquisition layer(assets());
  const std::vector<RawSamples> raw = blocks_of(recording());
  const std::vector<SampleBlock> blocks = send(layer, {raw.begin() + 2, raw.end()});
  ASSERT_EQ(blocks.size(), raw.size() - 2);
  EXPECT_EQ(blocks.front().boundary, BlockBoundary::inside);
  EXPECT_EQ(blocks.back().boundary, BlockBoundary::end);
}

TEST(DataAcquisition, CountsMissingRowsAndMissingBlocks) {
  std::vector<RawSamples> raw = blocks_of(recording());
  for (std::vector<double>* column : {&raw[1].samples.time_s})
    column->erase(column->begin() + 50, column->begin() + 57);
  for (Series& channel : raw[1].samples.channels)
    channel.values.erase(channel.values.begin() + 50, channel.values.begin() + 57);
  DataAcquisition some(assets());
  EXPECT_EQ(send(some, raw).back().dropped_samples, 7U);
  EXPECT_EQ(std::get<SampleBlock>(DataAcquisition(assets()).receive(raw[0]).outputs[0]).dropped_samples, 0U);

  raw.erase(raw.begin() + 3);
  DataAcquisition many(assets());
  const std::vector<SampleBlock> blocks = send(many, raw);
  EXPECT_EQ(blocks.back().dropped_samples, 207U);
  EXPECT_EQ(final_status(blocks, "flow").state, ChannelState::UNKNOWN) << "more than a tenth is missing";
  EXPECT_THAT(final_status(blocks, "flow").reason, HasSubstr("13 %"));
}

TEST(DataAcquisition, ABlockThatComesLateFillsItsGap) {
  std::vector<RawSamples> raw = blocks_of(recording());
  std::swap(raw[2], raw[3]);
  DataAcquisition layer(assets());
  const std::vector<SampleBlock> blocks = send(layer, raw);
  ASSERT_EQ(blocks.size(), raw.size());
  EXPECT_EQ(blocks[2].dropped_samples, 200U);
  EXPECT_EQ(blocks[3].block_number, 2U);
  EXPECT_EQ(blocks[3].samples.time_s.size(), 200U);
  EXPECT_EQ(blocks.back().dropped_samples, 0U);
  EXPECT_EQ(blocks.back().clock_steps_back, 0U);
}

TEST(DataAcquisition, LeavesOutRowsWhoseClockWentBack) {
  Recording test = recording();
  for (std::size_t i = 700; i < 710; ++i) test.samples.time_s[i] -= 1.0;
  test.samples.time_s[900] = kNaN;
  const std::vector<SampleBlock> blocks = send_all(test);
  EXPECT_EQ(blocks.back().clock_steps_back, 11U);
  EXPECT_EQ(blocks.back().dropped_samples, 11U) << "they leave gaps";
  std::vector<double> times;
  for (const SampleBlock& block : blocks)
    times.insert(times.end(), block.samples.time_s.begin(), block.samples.time_s.end());
  EXPECT_EQ(times.size(), test.samples.time_s.size() - 11);
  EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
}

TEST(ChannelStatus, ASensorThatFreezesIsFailed) {
  for (const char* channel : {"pressure_a", "flow", "position", "velocity", "shaft_speed", "motor_current"}) {
    Recording test = recording();
    std::vector<double>& series = values(test, channel);
    for (std::size_t i = 300; i < 500; ++i) series[i] = series[300];  // 6 s to 10 s, while the piston runs
    const ChannelStatus status = final_status(send_all(test), channel);
    EXPECT_EQ(status.state, ChannelState::FAILED) << channel;
    EXPECT_THAT(status.reason, HasSubstr("frozen at")) << channel;
    EXPECT_THAT(status.reason, HasSubstr("from 6.00 s")) << channel;
    const std::vector<SampleBlock> all = send_all(test);
    EXPECT_EQ(final_status(all, std::string(channel) == "flow" ? "position" : "flow").state, ChannelState::OK);
  }
}

TEST(ChannelStatus, ASensorThatNeverMovesIsFailed) {
  Recording test = recording();
  std::fill(values(test, "flow").begin(), values(test, "flow").end(), 0.0);
  EXPECT_EQ(final_status(send_all(test), "flow").state, ChannelState::FAILED);
}

TEST(ChannelStatus, WhatMayStandStillMayStandStill) {
  Recording test = recording();
  for (const char* channel : {"motor_voltage", "position", "velocity", "shaft_speed", "flow"}) {
    std::vector<double>& series = values(test, channel);
    const double level = std::string(channel) == "position" ? series[0] : 0.0;
    std::fill(series.begin(), series.begin() + 45, level);  // 0.9 s of rest without any noise
  }
  std::fill(values(test, "motor_voltage").begin(), values(test, "motor_voltage").end(), 12.0);
  test.samples.channels.push_back(
      {"fluid_temperature", "K", 0.0, std::vector<double>(test.samples.time_s.size(), 277.0)});
  const std::vector<SampleBlock> blocks = send_all(test);
  for (const char* channel : {"motor_voltage", "position", "velocity", "shaft_speed", "flow", "fluid_temperature"})
    EXPECT_EQ(final_status(blocks, channel).state, ChannelState::OK) << final_status(blocks, channel).reason;
}

TEST(ChannelStatus, OutOfRangeIsNoticedByTheAssetsRangeFirst) {
  Recording test = recording();
  std::vector<double>& pressure = values(test, "pressure_a");
  pressure[400] = 7e7;
  ChannelStatus status = final_status(send_all(test), "pressure_a");
  EXPECT_EQ(status.state, ChannelState::UNKNOWN) << "a single sample is no broken sensor";
  EXPECT_THAT(status.reason, HasSubstr("1 of 1551 samples out of range -1e+06..6e+07 Pa, worst 7e+07 at 8.00 s"));
  for (std::size_t i = 400; i < 500; ++i) pressure[i] = 7e7 + static_cast<double>(i);
  EXPECT_EQ(final_status(send_all(test), "pressure_a").state, ChannelState::FAILED);

  AssetConfig narrow = asset("XT03-MV2");
  narrow.sensors["flow"] = {
      .noise_std = 4e-8, .time_constant_s = 0.05, .quantisation = 0, .range_min = -1e-6, .range_max = 1e-6};
  DataAcquisition layer({narrow});
  EXPECT_EQ(final_status(send(layer, blocks_of(recording())), "flow").state, ChannelState::FAILED);
}

TEST(ChannelStatus, NotANumberIsNoticed) {
  Recording test = recording();
  values(test, "velocity")[100] = kNaN;
  std::fill(values(test, "flow").begin() + 100, values(test, "flow").end(), kNaN);
  const std::vector<SampleBlock> blocks = send_all(test);
  EXPECT_EQ(final_status(blocks, "velocity").state, ChannelState::UNKNOWN);
  EXPECT_EQ(final_status(blocks, "flow").state, ChannelState::FAILED);
  EXPECT_THAT(final_status(blocks, "flow").reason, HasSubstr("1451 of 1551 samples are not a number"));
}

TEST(ChannelStatus, ForeignChannelsUnitsAndAssetsAreReported) {
  Recording test = recording();
  for (Series& channel : test.samples.channels) {
    if (channel.name == "pressure_a") {
      channel.unit = "bar";
      for (double& value : channel.values) value /= 1e5;
    }
    if (channel.name == "flow") channel.unit = "furlong";
  }
  test.samples.channels.push_back({"vibration", "m/s2", 0.0, std::vector<double>(test.samples.time_s.size(), 1.0)});
  const std::vector<SampleBlock> blocks = send_all(test);
  EXPECT_EQ(final_status(blocks, "pressure_a").state, ChannelState::OK);
  EXPECT_NEAR(blocks[0].samples.find("pressure_a")->values[0], 1.17e7, 2e5);
  EXPECT_EQ(final_status(blocks, "flow").state, ChannelState::UNKNOWN);
  EXPECT_THAT(final_status(blocks, "flow").reason, HasSubstr("unit 'furlong'"));
  EXPECT_EQ(final_status(blocks, "vibration").state, ChannelState::UNKNOWN);
  EXPECT_THAT(final_status(blocks, "vibration").reason, HasSubstr("not a channel of plant eha"));
  EXPECT_FALSE(blocks[0].samples.has("vibration"));

  const std::vector<SampleBlock> unknown = send_all(recording(1, "NOBODY"));
  ASSERT_EQ(unknown.size(), 8U) << "nothing is lost";
  EXPECT_EQ(final_status(unknown, "flow").state, ChannelState::UNKNOWN);
  EXPECT_THAT(final_status(unknown, "flow").reason, HasSubstr("no plant is configured for asset 'NOBODY'"));
  EXPECT_TRUE(unknown[0].samples.has("flow"));
}

/// Everything that can go wrong, at random.
std::vector<Message> wild_inputs(unsigned seed) {
  std::mt19937 generator(seed);
  std::vector<RawSamples> raw;
  for (unsigned test = 1; test <= 3; ++test) {
    Recording one = recording(test, generator() % 3 == 0 ? "XT04-MV1" : "XT03-MV2");
    one.samples.time_s[generator() % 1500 + 5] -= 0.5;
    std::vector<double>& flow = values(one, "flow");
    std::fill(flow.begin() + 100, flow.begin() + 600, flow[100]);
    if (test == 2) one.samples.channels.front().name = "vibration";
    if (test == 3) one.start_time.reset(), one.recording_id = one.content_hash = "";
    for (RawSamples& block : blocks_of(one, 120)) raw.push_back(std::move(block));
  }
  for (int i = 0; i < 6; ++i) std::swap(raw[generator() % (raw.size() - 1)], raw[generator() % raw.size()]);
  for (int i = 0; i < 4; ++i) raw.erase(raw.begin() + static_cast<std::ptrdiff_t>(generator() % raw.size()));
  return {raw.begin(), raw.end()};
}

TEST(DataAcquisition, ComesBackFromItsOwnOutputsAtAnyPoint) {
  for (unsigned seed = 1; seed <= 4; ++seed)
    test::expect_restartable([] { return std::make_unique<DataAcquisition>(assets()); }, wild_inputs(seed));
}

TEST(DataAcquisitionOptions, NamesWhatIsWrong) {
  EXPECT_TRUE(DataAcquisitionOptions{}.validate());
  DataAcquisitionOptions options;
  options.gap_factor = 0.5;
  ASSERT_FALSE(options.validate());
  EXPECT_EQ(options.validate().error().place, "gap_factor");
}

/// Numbers that no sensor gives are marked as missing; the test and its other channels go on.
TEST(ChannelStatus, ANumberThatNoSensorGivesIsMarked) {
  Recording test = recording();
  const double wild[] = {1e308, -std::numeric_limits<double>::max(), std::numeric_limits<double>::infinity(), 1e12};
  for (std::size_t i = 0; i < std::size(wild); ++i) values(test, "position")[10 * i] = wild[i];
  values(test, "flow")[7] = 5e-324;
  test.samples.channels[0].noise_std = std::numeric_limits<double>::infinity();
  const std::vector<SampleBlock> blocks = send_all(test);
  EXPECT_THAT(final_status(blocks, "position").reason,
              HasSubstr("4 of 1551 samples are not a number that a sensor gives"));
  const std::vector<double>& position = blocks[0].samples.find("position")->values;
  for (std::size_t i = 0; i < std::size(wild); ++i) EXPECT_TRUE(std::isnan(position[10 * i]));
  EXPECT_EQ(position[5], values(test, "position")[5]);
  EXPECT_EQ(blocks[0].samples.find("flow")->values[7], 0.0);
  EXPECT_EQ(blocks[0].samples.channels[0].noise_std, 0.0);
}

/// One wild time takes no other row with it.
TEST(DataAcquisition, ATimeThatIsNoneIsLeftOutAlone) {
  Recording test = recording();
  test.samples.time_s[100] = 1e300;
  test.samples.time_s[200] = std::numeric_limits<double>::infinity();
  test.samples.time_s[300] = 1e9;
  const std::vector<SampleBlock> blocks = send_all(test);
  EXPECT_EQ(blocks.back().clock_steps_back, 3U);
  EXPECT_EQ(blocks.back().samples.time_s.back(), test.samples.time_s.back());
}

/// An open test whose sender never ends it.
TEST(DataAcquisition, ATestThatNeverEndsIsClosedAtItsLimitAndSaysSo) {
  DataAcquisition layer(assets());
  RawSamples raw = live_blocks_of(recording()).front();
  raw.samples = {.time_s = {}, .channels = {{"position", "m", 0.0, {}}}};
  std::vector<SampleBlock> blocks;
  constexpr std::uint64_t kRows = 100'000;
  for (std::uint64_t number = 0; number < 15; ++number) {
    raw.block_number = number;
    raw.boundary = number == 0 ? BlockBoundary::begin : BlockBoundary::inside;
    raw.header.message_id = "raw/" + std::to_string(number);
    raw.samples.time_s.clear();
    for (std::uint64_t row = 0; row < kRows; ++row)
      raw.samples.time_s.push_back(0.01 * static_cast<double>(number * kRows + row));
    raw.samples.channels[0].values.assign(kRows, 0.06);
    for (SampleBlock& block : send(layer, {raw})) blocks.push_back(std::move(block));
  }
  ASSERT_EQ(blocks.size(), 11U);  // 2 numbers a row: 10 blocks of them, and the one that says why
  EXPECT_EQ(blocks.back().boundary, BlockBoundary::end);
  EXPECT_TRUE(blocks.back().aborted);
  EXPECT_THAT(blocks.back().abort_reason, HasSubstr("refused: 2200000 numbers (rows times channels), more than"));
}

TEST(DataAcquisition, ABlockThatIsMoreThanATestMayBeIsATestThatSaysSo) {
  RawSamples raw = live_blocks_of(recording()).front();
  raw.samples.channels.assign(300, {"position", "m", 0.0, {}});
  DataAcquisition layer(assets());
  const std::vector<SampleBlock> blocks = send(layer, {raw});
  ASSERT_EQ(blocks.size(), 1U);
  EXPECT_EQ(blocks[0].boundary, BlockBoundary::whole);
  EXPECT_THAT(blocks[0].abort_reason, HasSubstr("refused: 300 channels, more than the 256"));
  EXPECT_TRUE(layer.is_closed(raw));
}

TEST(DataAcquisition, ATestOfManyDaysIsClosed) {
  DataAcquisition layer(assets());
  std::vector<RawSamples> raw = live_blocks_of(recording());
  for (double& time_s : raw[2].samples.time_s) time_s += 8.0 * 86400.0;
  const std::vector<SampleBlock> blocks = send(layer, raw);
  ASSERT_EQ(blocks.size(), 3U);
  EXPECT_THAT(blocks[2].abort_reason, HasSubstr("s long, more than the 604800 s"));
}

TEST(PstId, SaysThatATestWasMadeUp) {
  RawSamples raw = blocks_of(recording()).front();
  raw.source_id = "virtual_bench";
  DataAcquisition layer(assets());
  EXPECT_THAT(send(layer, {raw}).front().header.pst_id, testing::EndsWith("-simulated"));
}

}  // namespace
}  // namespace sealwatch
