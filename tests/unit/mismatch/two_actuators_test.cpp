// explain on something larger than a toy, within its own limit of a minute: config/plants/two_actuators.yaml has 22
// states and 7 sites.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "sealwatch/mismatch/explain.hpp"
#include "sealwatch/model/simulation.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "tests/unit/model/recording_for_tests.hpp"

namespace sealwatch {
namespace {

constexpr double kStep_s = 0.01;
constexpr int kRows = 800;

AssetConfig asset_of_plant() {
  const auto plant = load_plant(SEALWATCH_SOURCE_DIR "/config/plants/two_actuators.yaml");
  if (!plant) ADD_FAILURE() << combine(plant.error()).describe();
  return nominal_asset((*plant)->name);
}

/// Both valves move all the time, neither the way the other does.
TimeSeries commands(int test) {
  TimeSeries samples;
  for (const char* name : {"command_1", "command_2", "pump_speed", "supply_pressure", "pressure_a1", "pressure_b1",
                           "position_1", "pressure_a2", "pressure_b2", "position_2"})
    samples.channels.push_back({name, "", 0.0, std::vector<double>(kRows, 0.0)});
  for (int row = 0; row < kRows; ++row) {
    const double t = kStep_s * row, turn = 2.0 * std::numbers::pi;
    samples.time_s.push_back(t);
    const double other = 1.0 + 0.2 * test;
    samples.channels[0].values[row] = 2.2 * std::sin(0.21 * turn * t * other) + 1.6 * std::sin(0.57 * turn * t + test);
    samples.channels[1].values[row] = -2.4 * std::sin(0.16 * turn * t) - 1.5 * std::sin(0.43 * turn * t * other + 2.0);
    samples.channels[2].values[row] = 60.0 + 40.0 * std::sin(0.7 * t + test);
  }
  const auto start = [&](const char* channel, double value) {
    for (Series& series : samples.channels)
      if (series.name == channel) series.values.assign(kRows, value);
  };
  start("supply_pressure", 2.0e7);
  for (const char* channel : {"pressure_a1", "pressure_a2"}) start(channel, 8.0e6);
  for (const char* channel : {"pressure_b1", "pressure_b2"}) start(channel, 1.2e7);
  for (const char* channel : {"position_1", "position_2"}) start(channel, 0.12);
  return samples;
}

/// What the asset with its physics gives, with the sensors' noise.
Recording recorded(const AssetConfig& truth, int test) {
  Recording recording;
  recording.recording_id = "two_actuators_" + std::to_string(test);
  recording.samples = commands(test);
  const auto simulation = PlantSimulation::create(truth, recording.samples);
  EXPECT_TRUE(simulation) << simulation.error().describe();
  const auto outputs = (*simulation)->run((*simulation)->start(), {}, {.relative_tolerance = 1e-6});
  EXPECT_TRUE(outputs) << outputs.error().describe();
  std::mt19937 random(static_cast<unsigned>(test));
  std::normal_distribution<double> normal;
  for (std::size_t k = 0; k < (*simulation)->channels().size(); ++k)
    for (Series& series : recording.samples.channels) {
      if (series.name != (*simulation)->channels()[k]) continue;
      const double noise = series.name.starts_with("position") ? 1e-5 : 1e4;
      for (int row = 0; row < kRows; ++row)
        series.values[row] = outputs->values(row, static_cast<Eigen::Index>(k)) + noise * normal(random);
    }
  return recording;
}

mismatch::Explanation explained(const AssetConfig& truth) {
  const auto found = mismatch::explain(asset_of_plant(), std::vector{recorded(truth, 1), recorded(truth, 2)},
                                       std::vector{recorded(truth, 3)});
  EXPECT_TRUE(found) << found.error().describe();
  return found ? *found : mismatch::Explanation{};
}

TEST(TwoActuators, AreConsistentWhereNothingIsMissing) {
  AssetConfig truth = asset_of_plant();
  truth.parameters.at("B").value = 1.1e9;
  truth.parameters.at("K_v1").value = 4.9e-8;
  const mismatch::Explanation found = explained(truth);
  EXPECT_EQ(found.verdict, MismatchVerdict::consistent) << found.summary;
}

TEST(TwoActuators, ALeakingSealOfOneOfThemIsNamed) {
  AssetConfig truth = asset_of_plant();
  PhysicsTerm leak{.id = "turbulent_seal_leakage", .element = "seal_1", .parameters = {}};
  leak.parameters = {{"k", {1.5e-9, 0.0, 1e-7, true}}};
  truth.physics = {leak};
  const mismatch::Explanation found = explained(truth);
  ASSERT_EQ(found.verdict, MismatchVerdict::mismatch) << found.summary;
  ASSERT_EQ(found.effects.size(), 1U) << found.summary;
  EXPECT_EQ(found.effects[0].what.id, "turbulent_seal_leakage") << found.summary;
  EXPECT_EQ(found.effects[0].what.element, "seal_1") << found.summary;
}

}  // namespace
}  // namespace sealwatch
