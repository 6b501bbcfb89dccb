// Events in a simulation: a ball that bounces and is thrown, against its parabolas in closed form; Co-Simulation units.
#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <regex>
#include <sstream>

#include "sealwatch/estimation/actuator_fit.hpp"
#include "sealwatch/model/simulation.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "tests/unit/fmi/fmu_builder.hpp"
#include "tests/unit/model/recording_for_tests.hpp"

namespace sealwatch::fmi {
namespace {

constexpr double kGravity = 9.81, kBounce = 0.7, kThrow = 3.0, kThrowEvery_s = 0.7;

struct Ball {
  double height, velocity;
};

/// Piece by piece, each event at its exact time.
Ball ball(double time, double gravity = kGravity, double bounce = kBounce) {
  double t = 0.0, h = 1.0, v = 0.0, next_throw = kThrowEvery_s;
  for (;;) {
    const double ground = t + (v + std::sqrt(v * v + 2.0 * gravity * h)) / gravity;
    const double until = std::min({time, ground, next_throw});
    const double dt = until - t;
    h += v * dt - 0.5 * gravity * dt * dt;
    v -= gravity * dt;
    t = until;
    if (until == time) return {h, v};
    if (until == next_throw) {
      v = kThrow;
      next_throw += kThrowEvery_s;
    } else {
      h = 0.0;
      v = -bounce * v;
    }
  }
}

double height(double time, double gravity = kGravity, double bounce = kBounce) {
  return ball(time, gravity, bounce).height;
}

std::string ball_file(const TestFolder& folder, const std::string& name) {
  const std::string file = (folder / "plant.yaml").string();
  std::ofstream(file) << "name: " << name << R"yaml(
meaning: a ball
fmu:
  file: model.fmu
  parameters: {g: g, e: e}
  variables: {h: {variable: height, unit: m}}
outputs:
  height: {value: h, unit: m, noise_std: 1.0e-4}
  velocity: {value: v, unit: m/s, noise_std: 1.0e-3}
parameters:
  g: {value: 9.81, unit: m/s2, estimate: true}
  e: {value: 0.7, unit: "1", estimate: true}
states:
  hs: {variable: h, unit: m, start: "1.0[m]", own: false, size: 1.0}
  v: {variable: v, unit: m/s, start: "0[m/s]", own: false, size: 1.0}
law_sizes: {}
)yaml";
  return file;
}

TimeSeries watched() {
  TimeSeries samples;
  samples.channels = {{"height", "m", 0.0, {}}};
  for (int row = 0; row <= 200; ++row) {
    samples.time_s.push_back(0.01 * row);
    samples.channels[0].values.push_back(0.0);
  }
  return samples;
}

TEST(FmuEvents, StateAndTimeEventsAreWhereTheyShouldBe) {
  for (const char* binary : {"fmu_bouncing2", "fmu_bouncing3"}) {
    const TestFolder folder;
    const std::string fmu = folder.build(bouncing(binary));
    const auto plant = load_plant(ball_file(folder, std::string("ball_") + binary));
    ASSERT_TRUE(plant) << plant.error().front().describe();
    const auto simulation = PlantSimulation::create(nominal_asset((*plant)->name), watched());
    ASSERT_TRUE(simulation) << simulation.error().describe();
    const auto outputs = (*simulation)->run((*simulation)->start(), {}, {.relative_tolerance = 1e-7});
    ASSERT_TRUE(outputs) << outputs.error().describe();
    for (int row = 0; row <= 200; ++row)
      EXPECT_NEAR(outputs->values(row, 0), height(0.01 * row), 1e-6) << binary << " at " << 0.01 * row;
  }
}

/// The file's plant with another start; its heights from 0 to 2 s.
std::vector<double> heights_from(const TestFolder& folder, const std::string& name, const std::string& height_start,
                                 const std::string& velocity_start) {
  const std::string file = ball_file(folder, name);
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  std::string changed = std::regex_replace(text.str(), std::regex("\"1.0\\[m\\]\""), height_start);
  std::ofstream(file) << std::regex_replace(changed, std::regex("\"0\\[m/s\\]\""), velocity_start);
  const auto plant = load_plant(file);
  EXPECT_TRUE(plant) << plant.error().front().describe();
  const auto simulation = PlantSimulation::create(nominal_asset(name), watched());
  EXPECT_TRUE(simulation) << simulation.error().describe();
  const auto outputs = (*simulation)->run((*simulation)->start(), {}, {.relative_tolerance = 1e-7});
  EXPECT_TRUE(outputs) << outputs.error().describe();
  std::vector<double> heights;
  for (int row = 0; row <= 200 && outputs; ++row) heights.push_back(outputs->values(row, 0));
  return heights;
}

// Dry friction that switches with the sign of the speed takes ever shorter steps where it sticks.
TEST(FmuEvents, ASwitchThatChattersIsNamedSoon) {
  const TestFolder folder;
  TestUnit unit = bouncing("fmu_bouncing2");
  unit.binary = "fmu_relay2";
  static_cast<void>(folder.build(unit));
  const auto plant = load_plant(ball_file(folder, "chattering"));
  ASSERT_TRUE(plant) << plant.error().front().describe();
  const auto simulation = PlantSimulation::create(nominal_asset("chattering"), watched());
  ASSERT_TRUE(simulation) << simulation.error().describe();
  ModelValues values = (*simulation)->start();
  values.initial_state[0] = 0.02;
  const auto begin = std::chrono::steady_clock::now();
  const auto outputs = (*simulation)->run(values, {}, {.maximum_steps = 5'000'000});
  ASSERT_FALSE(outputs);
  EXPECT_THAT(outputs.error().describe(), testing::AllOf(testing::HasSubstr("events follow each other without end"),
                                                         testing::HasSubstr("a hysteresis, or round it")));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
}

TEST(FmuEvents, AStateEventAtTheVeryBeginningIsPassed) {
  const TestFolder folder;
  const std::string fmu = folder.build(bouncing("fmu_bouncing2"));
  const std::vector<double> found = heights_from(folder, "ball_from_the_ground", "\"0[m]\"", "\"-2.0[m/s]\"");
  ASSERT_EQ(found.size(), 201U);
  for (std::size_t row = 0; row <= 28; ++row) {  // it comes down after 0.285 s
    const double t = 0.01 * static_cast<double>(row);
    EXPECT_NEAR(found[row], 2.0 * kBounce * t - 0.5 * kGravity * t * t, 1e-6) << t;
  }
}

TEST(FmuEvents, ATimeEventAtTheVeryBeginningIsPassed) {
  const TestFolder folder;
  const std::string fmu = folder.build(bouncing("fmu_thrown_at_once2"));
  const std::vector<double> found = heights_from(folder, "ball_thrown_at_once", "\"1.0[m]\"", "fmu");
  ASSERT_EQ(found.size(), 201U);
  for (std::size_t row = 0; row <= 70; ++row) {
    const double t = 0.01 * static_cast<double>(row);
    EXPECT_NEAR(found[row], 1.0 + kThrow * t - 0.5 * kGravity * t * t, 1e-6) << t;
  }
  for (std::size_t row = 71; row <= 90; ++row) {
    const double t = 0.01 * static_cast<double>(row) - 0.7, thrown = 1.0 + kThrow * 0.7 - 0.5 * kGravity * 0.49;
    EXPECT_NEAR(found[row], thrown + kThrow * t - 0.5 * kGravity * t * t, 1e-6) << t;
  }
}

TEST(FmuEvents, SensitivitiesAcrossJumpsAreThoseOfTheWholeCourse) {
  const TestFolder folder;
  const std::string fmu = folder.build(bouncing("fmu_bouncing2"));
  const auto plant = load_plant(ball_file(folder, "ball_differentiated"));
  ASSERT_TRUE(plant) << plant.error().front().describe();
  const auto simulation = PlantSimulation::create(nominal_asset("ball_differentiated"), watched());
  ASSERT_TRUE(simulation);
  const std::vector<FreeQuantity> free = {*(*simulation)->find("g"), *(*simulation)->find("e")};
  const auto outputs = (*simulation)->run((*simulation)->start(), free);
  ASSERT_TRUE(outputs) << outputs.error().describe();
  constexpr double kStep = 1e-6;
  int far = 0;  // samples just beside an event, where the ball turns, may differ
  for (int row = 0; row <= 200; ++row) {
    const double t = 0.01 * row;
    const double by_g = (height(t, kGravity + kStep) - height(t, kGravity - kStep)) / (2.0 * kStep);
    const double by_e = (height(t, kGravity, kBounce + kStep) - height(t, kGravity, kBounce - kStep)) / (2.0 * kStep);
    far += std::abs(outputs->sensitivities(row, 0) - by_g) > 2e-3 ? 1 : 0;
    far += std::abs(outputs->sensitivities(row, 1) - by_e) > 2e-2 ? 1 : 0;
  }
  EXPECT_LE(far, 8);
}

// From the start's values every impact falls beside the recorded one, where the velocity jumps: the sum of squares has
// minima of its own on the way.
TEST(FmuEvents, ParametersThatMoveTheImpactsAreFound) {
  const TestFolder folder;
  const std::string fmu = folder.build(bouncing("fmu_bouncing2"));
  const auto plant = load_plant(ball_file(folder, "ball_fitted"));
  ASSERT_TRUE(plant) << plant.error().front().describe();
  for (const auto& [gravity, bounce] : {std::pair{9.3, 0.76}, {9.7, 0.72}, {11.0, 0.6}, {7.0, 0.75}}) {
    TimeSeries samples = watched();
    samples.channels.push_back({"velocity", "m/s", 0.0, {}});
    for (std::size_t row = 0; row < samples.time_s.size(); ++row) {
      const Ball at = ball(samples.time_s[row], gravity, bounce);
      const double noise = std::sin(37.0 * static_cast<double>(row * row));  // uneven
      samples.channels[0].values[row] = at.height + 1e-4 * noise;
      samples.channels[1].values.push_back(at.velocity - 1e-3 * noise);
    }
    const JointFit fit = fit_actuator(nominal_asset("ball_fitted"), std::span(&samples, 1));
    ASSERT_TRUE(fit.report.admissible) << gravity << ": " << ::testing::PrintToString(fit.report.reasons);
    EXPECT_NEAR(fit.report.parameters[0].value, gravity, 2e-3);
    EXPECT_NEAR(fit.report.parameters[1].value, bounce, 2e-4);
  }
}

TEST(FmuEvents, ARecordingWithoutNoiseIsFittedToWhatAnIntegrationErrsBy) {
  const TestFolder folder;
  const std::string fmu = folder.build(bouncing("fmu_bouncing2"));
  const std::string file = ball_file(folder, "ball_without_noise");
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  std::ofstream(file) << std::regex_replace(text.str(), std::regex(", noise_std: [^}]*"), "");
  const auto plant = load_plant(file);
  ASSERT_TRUE(plant) << plant.error().front().describe();
  TimeSeries samples = watched();
  samples.channels.push_back({"velocity", "m/s", 0.0, {}});
  for (std::size_t row = 0; row < samples.time_s.size(); ++row) {
    const Ball at = ball(samples.time_s[row], 9.3, 0.76);
    samples.channels[0].values[row] = at.height;
    samples.channels[1].values.push_back(at.velocity);
  }
  const JointFit fit = fit_actuator(nominal_asset("ball_without_noise"), std::span(&samples, 1));
  ASSERT_TRUE(fit.report.admissible) << ::testing::PrintToString(fit.report.reasons);
  EXPECT_NEAR(fit.report.parameters[0].value, 9.3, 1e-4);
  EXPECT_NEAR(fit.report.parameters[1].value, 0.76, 1e-5);
}

}  // namespace
}  // namespace sealwatch::fmi
