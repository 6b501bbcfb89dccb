// explain on plants that are written as text (config/plants): the built-in plant's verdict on the same recordings, and the
// literature's naive models against real recordings.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "sealwatch/mismatch/explain.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "tests/unit/model/recording_for_tests.hpp"

namespace sealwatch {
namespace {

AssetConfig asset_of_file(const std::string& name) {
  const auto plant = load_plant(SEALWATCH_SOURCE_DIR "/config/plants/" + name + ".yaml");
  if (!plant) ADD_FAILURE() << combine(plant.error()).describe();
  return nominal_asset((*plant)->name);
}

bool recorded(const std::string& folder) {
  return std::filesystem::exists(std::filesystem::path(SEALWATCH_SHARED_DATA) / folder);
}

Recording recording_of(const std::string& file) {
  Recording recording;
  recording.recording_id = std::filesystem::path(file).stem();
  recording.samples = read_recording(std::filesystem::path(SEALWATCH_SHARED_DATA) / file);
  return recording;
}

bool names(const mismatch::Explanation& found, const std::string& id) {
  const auto is_it = [&](const mismatch::LawAt& law) { return law.id == id; };
  return std::ranges::any_of(found.effects, [&](const mismatch::FoundEffect& effect) {
    return is_it(effect.what) || std::ranges::any_of(effect.indistinguishable, is_it);
  });
}

TEST(TextPlants, ExplainTheTanksAsTheBuiltInPlantDoes) {
  if (!recorded("cascaded_tanks")) GTEST_SKIP() << "no public recordings";
  const std::vector<Recording> one = {recording_of("cascaded_tanks/train.csv")};
  const auto native = mismatch::explain(nominal_asset("cascaded_tanks"), one, {});
  const auto text = mismatch::explain(asset_of_file("cascaded_tanks"), one, {});
  ASSERT_TRUE(native) << native.error().describe();
  ASSERT_TRUE(text) << text.error().describe();
  EXPECT_EQ(native->verdict, text->verdict) << native->summary << "\n" << text->summary;
  // Which of several that predict alike comes first is the integrator's last digits.
  for (const auto& [one_of, other] : {std::pair{&*native, &*text}, std::pair{&*text, &*native}})
    for (const mismatch::FoundEffect& effect : one_of->effects)
      EXPECT_TRUE(names(*other, effect.what.id)) << effect.what.id << ": " << other->summary;
  EXPECT_EQ(native->location.at(0).element, text->location.at(0).element);
  for (const mismatch::Explanation* found : {&*native, &*text}) {
    const mismatch::ChannelComparison& level = found->holdout.channels.at(0);
    EXPECT_LT(level.rms_after, 0.8 * level.rms_before) << found->summary;
  }
}

/// A law of the plant's own is tried beside those of the catalogue.
TEST(TextPlants, FindTheSilverboxsSpringAndOffset) {
  if (!recorded("silverbox")) GTEST_SKIP() << "no public recordings";
  std::vector<Recording> fit = {recording_of("silverbox/multisine_1.csv")};
  std::vector<Recording> holdout = {recording_of("silverbox/multisine_3.csv")};
  constexpr std::size_t kRows = 2000;  // as many say as much
  for (std::vector<Recording>* all : {&fit, &holdout}) {
    all->front().samples.time_s.resize(kRows);
    for (Series& series : all->front().samples.channels) series.values.resize(kRows);
  }
  const auto found = mismatch::explain(asset_of_file("silverbox"), fit, holdout);
  ASSERT_TRUE(found) << found.error().describe();
  EXPECT_EQ(found->verdict, MismatchVerdict::mismatch) << found->summary;
  for (const char* id : {"duffing_spring", "constant_force"})
    EXPECT_TRUE(names(*found, id)) << id << ": " << found->summary;
  const mismatch::ChannelComparison& y = found->holdout.channels.at(0);
  EXPECT_LT(y.rms_after, 0.1 * y.rms_before) << found->summary;
  constexpr double kGoal = 6e-4;  // V, free run of a piece that took no part; linear models miss by 7 mV
  EXPECT_LT(y.rms_after * found->recordings.back().recorded.channels.at(0).noise_std, kGoal);
}

TEST(TextPlants, FindTheFrictionOfAnORingInAPlantWithoutStates) {
  if (!recorded("seal_friction")) GTEST_SKIP() << "no public recordings";
  const std::vector<Recording> fit = {recording_of("seal_friction/run1_1bar.csv"),
                                      recording_of("seal_friction/run1_5bar.csv")};
  const std::vector<Recording> holdout = {recording_of("seal_friction/run1_3bar.csv")};
  const auto found = mismatch::explain(asset_of_file("seal_friction"), fit, holdout);
  ASSERT_TRUE(found) << found.error().describe();
  EXPECT_EQ(found->location.at(0).element, "piston") << found->summary;
  EXPECT_TRUE(names(*found, "pressure_dependent_friction")) << found->summary;
  const mismatch::ChannelComparison& force = found->holdout.channels.at(0);
  EXPECT_LT(force.rms_after, 0.25 * force.rms_before) << "a pressure that took no part";
}

}  // namespace
}  // namespace sealwatch
