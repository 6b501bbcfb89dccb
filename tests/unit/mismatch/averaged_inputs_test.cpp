// Far from the recordings a held input may be averaged: as much is found, in a fraction of the steps.
#include <gtest/gtest.h>

#include <algorithm>

#include "sealwatch/mismatch/explain.hpp"
#include "sealwatch/model/physics.hpp"
#include "services/common/mismatch/averaged_inputs.hpp"
#include "services/common/mismatch/criterion.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "tests/unit/mismatch/simulated_test.hpp"

namespace sealwatch::mismatch {
namespace {

AssetConfig actuator() { return load_asset(SEALWATCH_SOURCE_DIR "/config/assets/xt03-mv2.yaml").value(); }

AssetConfig with_spring(AssetConfig asset, double stiffness) {
  return with_law(std::move(asset), **find_law("spring_load", {"k"}), "piston", std::vector{stiffness});
}

Recording held_recording_of(const AssetConfig& truth, double load) {
  return recording_of(truth, load, [](TimeSeries& samples) { samples.input_hold = true; });
}

Data held_data_of(const AssetConfig& truth) {
  Data data;
  for (const double load : {0.8, 1.1}) {
    data.names.push_back(number(load));
    data.samples.push_back(held_recording_of(truth, load).samples);
  }
  return data;
}

std::size_t steps(const AssetConfig& asset, const TimeSeries& samples) {
  const auto simulation = PlantSimulation::create(asset, samples).value();
  return simulation->run(simulation->start(), {}).value().steps;
}

bool is_said(const Explanation& found, std::string_view words) {
  return std::ranges::any_of(found.notes,
                             [&](const std::string& note) { return note.find(words) != std::string::npos; });
}

TEST(AveragedInputs, AreTheMeansOfNeighbouringSamplesOfWhatIsHeld) {
  const AssetConfig asset = actuator();
  Data data;
  data.samples = {{.time_s = {0.0, 0.1, 0.2},
                   .channels = {{"motor_voltage", "V", 0.0, {1.0, 3.0, 4.0}}, {"position", "m", 0.0, {1.0, 3.0, 4.0}}},
                   .input_hold = true}};
  const std::optional<Data> averaged = with_averaged_inputs(asset, data);
  ASSERT_TRUE(averaged);
  EXPECT_FALSE(averaged->samples[0].input_hold);
  EXPECT_EQ(averaged->samples[0].channels[0].values, (std::vector{1.0, 2.0, 3.5}));
  EXPECT_EQ(averaged->samples[0].channels[1].values, data.samples[0].channels[1].values);
  data.samples[0].input_hold = false;
  EXPECT_FALSE(with_averaged_inputs(asset, data));
}

TEST(AveragedInputs, WhatThePlantItselfHoldsStaysHeld) {
  const PlantDescription& plant = **find_plant("eha_switched");
  const auto held = std::ranges::find_if(plant.channels, [](const auto& one) { return one.input && one.hold; });
  ASSERT_NE(held, plant.channels.end());
  AssetConfig asset;
  asset.model = plant.name;
  Data data;
  data.samples = {{.time_s = {0.0, 0.1}, .channels = {{held->name, held->unit, 0.0, {0.0, 1.0}}}, .input_hold = true}};
  EXPECT_FALSE(with_averaged_inputs(asset, data));
}

TEST(AveragedInputs, TakeFewerStepsAndMissByAsMuchFarFromTheRecordingsAlone) {
  const AssetConfig asset = actuator();
  const Data far = held_data_of(with_spring(asset, 4e5));
  const auto baseline = fit_model(asset, far, nullptr, 2);
  ASSERT_TRUE(baseline);
  ASSERT_GT(excess(*baseline), 30.0);
  const std::optional<Averaged> rough = averaged(*baseline, far, 2);
  ASSERT_TRUE(rough);
  EXPECT_NEAR(rough->model->misfit, baseline->misfit, 0.1 * baseline->misfit);
  EXPECT_LT(3 * steps(asset, rough->data.samples[0]), 2 * steps(asset, far.samples[0]));

  const Data near = held_data_of(asset);
  const auto fitted = fit_model(asset, near, nullptr, 2);
  ASSERT_TRUE(fitted);
  EXPECT_FALSE(averaged(*fitted, near, 2));
}

TEST(AveragedInputs, TheSearchGoesOnWithTheHeldInputOnceItIsNear) {
  const AssetConfig asset = actuator(), truth = with_spring(asset, 4e5);
  const std::vector<Recording> fit = {held_recording_of(truth, 0.8), held_recording_of(truth, 1.1)},
                               holdout = {held_recording_of(truth, 1.3)};
  ExplainOptions options;
  options.threads = 2;
  options.time_limit_s = 600.0;
  const auto found = explain(asset, fit, holdout, options, {});
  ASSERT_TRUE(found) << found.error().describe();
  ASSERT_EQ(found->effects.size(), 1U);
  EXPECT_EQ(found->effects[0].what.id, "spring_load");
  EXPECT_FALSE(is_said(*found, "averaged"));
  for (const ChannelComparison& channel : found->holdout.channels) EXPECT_LT(channel.rms_after, 1.1) << channel.channel;
}

}  // namespace
}  // namespace sealwatch::mismatch
