// What recordings say of others that took no part in their fit.
#include "services/common/mismatch/held_out.hpp"

#include <gtest/gtest.h>

#include "sealwatch/model/physics.hpp"
#include "services/common/mismatch/explain_input.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "tests/unit/mismatch/simulated_test.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kGain = 0.03;

AssetConfig with_gain() {
  AssetConfig asset = load_asset(SEALWATCH_SOURCE_DIR "/config/assets/xt03-mv2.yaml").value();
  asset.physics.push_back({.id = "input_gain",
                           .element = "input:motor_voltage",
                           .parameters = {{"g", {.value = kGain, .min = -0.5, .max = 0.5, .estimate = true}}}});
  return asset;
}

Recording moves(const AssetConfig& truth, double load) { return recording_of(truth, load); }

Recording unpowered(const AssetConfig& truth, double load) {
  Recording recording = recording_of(truth, load);
  TimeSeries samples = standard_pst(truth, 100.0, 3.0);
  std::ranges::fill(samples.channels.front().values, 0.0);
  recording.samples = simulated(truth, std::move(samples), 1.0);
  return recording;
}

double gain_for_the_first(const std::vector<Recording>& recordings, const AssetConfig& asset) {
  const Data fit = data_of(recordings), none;
  const ExplainOptions options;
  const Trial trial{{{find_law("input_gain", {"g"}).value(), asset.physics.front().element}},
                    std::make_shared<const FittedModel>(fit_model(asset, fit, nullptr, 2).value())};
  EXPECT_NEAR(trial.model->asset.physics.front().parameters.at("g").value, kGain, 0.1 * kGain);
  const auto predictions = HeldOut{fit, none, 0.0, options}.predictions(trial);
  return predictions->front().value().asset.physics.front().parameters.at("g").value;
}

// Without voltage its gain does nothing: such a law acts in one recording alone. The others do not tell its strength, and
// what it does there is not predicted.
TEST(HeldOut, ALawThatTheOthersDoNotTellIsNoPredictionOfTheirs) {
  const AssetConfig asset = with_gain();
  EXPECT_EQ(gain_for_the_first({moves(asset, 0.8), unpowered(asset, 1.0), unpowered(asset, 1.2)}, asset), 0.0);
}

TEST(HeldOut, ALawThatTheOthersTellIs) {
  const AssetConfig asset = with_gain();
  EXPECT_NEAR(gain_for_the_first({moves(asset, 0.8), moves(asset, 1.0), unpowered(asset, 1.2)}, asset), kGain,
              0.1 * kGain);
}

}  // namespace
}  // namespace sealwatch::mismatch
