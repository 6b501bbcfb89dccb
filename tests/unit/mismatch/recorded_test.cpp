// Channels whose sensor shows nothing are refused; those that round or saturate are not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sealwatch/mismatch/explain.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "services/common/mismatch/explain_input.hpp"
#include "services/common/mismatch/recorded_units.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "tests/unit/mismatch/simulated_test.hpp"

namespace sealwatch::mismatch {
namespace {

AssetConfig actuator() { return load_asset(SEALWATCH_SOURCE_DIR "/config/assets/xt03-mv2.yaml").value(); }

TEST(Recorded, AChannelThatNeverChangesWhileThePistonMovesIsRefused) {
  const AssetConfig asset = actuator();
  std::vector<Recording> fit{recording_of(asset, 0.8), recording_of(asset, 1.2)};
  for (Series& channel : fit[1].samples.channels)
    if (channel.name == "pressure_b") std::ranges::fill(channel.values, 1.8e6);
  const auto refused = explain(asset, fit, {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().place, "column pressure_b");
  EXPECT_EQ(refused.error().file, fit[1].file);
}

std::vector<double>& values_of(Recording& recording, const std::string& channel) {
  return std::ranges::find(recording.samples.channels, channel, &Series::name)->values;
}

void freeze(std::vector<double>& values, std::size_t begin) {
  std::fill(values.begin() + static_cast<std::ptrdiff_t>(begin), values.end(), values[begin]);
}

void round_to(std::vector<double>& values, double step) {
  for (double& value : values) value = step * std::round(value / step);
}

TEST(Recorded, AChannelThatStopsHalfWayIsRefused) {
  const AssetConfig asset = actuator();
  std::vector<Recording> fit{recording_of(asset, 0.8), recording_of(asset, 1.2)};
  freeze(values_of(fit[1], "velocity"), 1550);
  const Status refused = check(asset, fit, {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().place, "column velocity");
  EXPECT_EQ(refused.error().file, fit[1].file);
  EXPECT_NE(refused.error().rule.find("does not change from 15.5 s to 30.99 s"), std::string::npos)
      << refused.error().rule;

  fit[1] = recording_of(asset, 1.2);
  round_to(values_of(fit[1], "pressure_a"), 1e4);
  EXPECT_TRUE(check(asset, fit, {})) << "it rounds to its noise";
  freeze(values_of(fit[1], "pressure_a"), 1550);
  EXPECT_FALSE(check(asset, fit, {})) << "it rounds, and then stops";
}

TEST(Recorded, AChannelThatRoundsCoarselyOrIsAtTheEndOfItsRangeIsNotStuck) {
  const AssetConfig asset = actuator();
  std::vector<Recording> fit{recording_of(asset, 0.8), recording_of(asset, 1.2)};
  round_to(values_of(fit[0], "velocity"), 1e-3);
  std::vector<double>& pressure = values_of(fit[1], "pressure_b");
  std::vector<double> sorted = pressure;
  std::ranges::sort(sorted);
  const double end = sorted[sorted.size() / 3];
  for (double& value : pressure) value = std::max(value, end);
  const Status accepted = check(asset, fit, {});
  EXPECT_TRUE(accepted) << accepted.error().describe();
}

TEST(Recorded, RecordingsOfOneIdGoByTheirFiles) {
  Recording first, second, third;
  first.recording_id = second.recording_id = "2031-04-12-PST";
  first.file = "a/pst.csv";
  second.file = "b/pst.csv";
  third.recording_id = "2031-05-12-PST";
  const std::vector<Recording> fit{first, third}, holdout{second};
  EXPECT_EQ(data_of(fit, holdout).names, (std::vector<std::string>{"a/pst.csv", "2031-05-12-PST"}));
  EXPECT_EQ(data_of(holdout, fit).names, (std::vector<std::string>{"b/pst.csv"}));
  EXPECT_EQ(data_of(fit).names, (std::vector<std::string>{"2031-04-12-PST", "2031-05-12-PST"}));
}

// A recorded pressure in bar under a header of pascal, and one in pascal under a header of bar.
TEST(Recorded, AColumnInAnotherUnitIsSuspectedByName) {
  const AssetConfig asset = actuator();
  std::vector<Recording> fit{recording_of(asset, 0.8)};
  const PlantDescription& plant = **find_plant("eha");
  const TimeSeries right = fit[0].samples;
  EXPECT_EQ(another_unit(plant, right), "");
  std::ranges::fill_n(values_of(fit[0], "pressure_a").begin(), 40, 1e12);  // wild samples are not another unit
  EXPECT_EQ(another_unit(plant, fit[0].samples), "");
  fit[0].samples = right;
  for (double& value : values_of(fit[0], "pressure_a")) value *= 1e5;
  EXPECT_TRUE(another_unit(plant, fit[0].samples).starts_with("column pressure_a goes to "))
      << another_unit(plant, fit[0].samples);
  const std::vector<Recording> good{recording_of(asset, 1.2)};
  const auto refused = explain(asset, good, fit);  // the one that is held out
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().describe().find("check the units in its header"), std::string::npos)
      << refused.error().describe();
  EXPECT_EQ(refused.error().file, "0.8");

  fit[0].samples = right;
  for (double& value : values_of(fit[0], "position")) value *= 1e-3;
  EXPECT_TRUE(
      another_unit(plant, fit[0].samples).starts_with("column position moves 0.001 times as far as column velocity"))
      << another_unit(plant, fit[0].samples);

  fit[0].samples = right;  // an offset adds up, a resting piston has a way of noise alone: neither is a unit
  for (double& value : values_of(fit[0], "velocity")) value += 1e-2;
  EXPECT_EQ(another_unit(plant, fit[0].samples), "");
  for (double& value : values_of(fit[0], "position")) value = 0.06 + 1e-9 * value;
  std::ranges::fill(values_of(fit[0], "velocity"), 1e-3);
  EXPECT_EQ(another_unit(plant, fit[0].samples), "");

  PooledFit pooled{.channels = {{.channel = "pressure_b", .nrmse_before = 40.0},
                                {.channel = "pressure_a", .nrmse_before = -99900.0}}};
  EXPECT_EQ(hardly_moves(pooled),
            "the simulation's pressure A moves some 1000 times as much as the recorded one: check the unit in the "
            "header of column pressure_a");
  pooled.channels.pop_back();
  EXPECT_EQ(hardly_moves(pooled), "");
}

}  // namespace
}  // namespace sealwatch::mismatch
