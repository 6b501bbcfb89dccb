// What recordings say of others that took no part in their fit.
#include "services/common/mismatch/held_out.hpp"

#include <gtest/gtest.h>

#include "services/common/mismatch/explain_input.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "tests/unit/mismatch/simulated_test.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kDrag = 3e9;

AssetConfig with_drag() {
  AssetConfig asset = load_asset(SEALWATCH_SOURCE_DIR "/config/assets/xt03-mv2.yaml").value();
  asset.physics.push_back({.id = "quadratic_drag",
                           .element = "piston",
                           .parameters = {{"k", {.value = kDrag, .min = 0.0, .max = 1e12, .estimate = true}}}});
  return asset;
}

Recording moves(const AssetConfig& truth, double load) { return recording_of(truth, load); }

Recording rests(const AssetConfig& truth, double load) {
  Recording recording = recording_of(truth, load);
  TimeSeries samples = standard_pst(truth, 100.0, 10.0);
  std::ranges::fill(samples.channels.front().values, samples.channels.front().values.front());
  recording.samples = simulated(truth, std::move(samples), 1.0);
  return recording;
}

double drag_for_the_first(const std::vector<Recording>& recordings, const AssetConfig& asset) {
  const Data fit = data_of(recordings), none;
  const ExplainOptions options;
  const Trial trial{{{find_law("quadratic_drag", {"k"}).value(), asset.physics.front().element}},
                    std::make_shared<const FittedModel>(fit_model(asset, fit, nullptr, 2).value())};
  EXPECT_NEAR(trial.model->asset.physics.front().parameters.at("k").value, kDrag, 0.1 * kDrag);
  const Predictions predictions = HeldOut{fit, none, 0.0, options}.predictions(trial);
  return predictions.front().value().asset.physics.front().parameters.at("k").value;
}

// A law acts in one recording alone: the others do not tell its strength, and what it does there is not predicted.
TEST(HeldOut, ALawThatTheOthersDoNotTellIsNoPredictionOfTheirs) {
  const AssetConfig asset = with_drag();
  EXPECT_EQ(drag_for_the_first({moves(asset, 0.8), rests(asset, 1.0), rests(asset, 1.2)}, asset), 0.0);
}

TEST(HeldOut, ALawThatTheOthersTellIs) {
  const AssetConfig asset = with_drag();
  EXPECT_NEAR(drag_for_the_first({moves(asset, 0.8), moves(asset, 1.0), rests(asset, 1.2)}, asset), kDrag, 0.1 * kDrag);
}

}  // namespace
}  // namespace sealwatch::mismatch
