// explain where the simulation from the model's values is far off: a cart that no spring pulls back, so that what it lacks
// adds up over the whole recording.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>

#include "sealwatch/mismatch/explain.hpp"
#include "sealwatch/model/simulation.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "tests/unit/model/recording_for_tests.hpp"

namespace sealwatch {
namespace {

constexpr const char* kCart = R"yaml(name: cart
meaning: cart on rails, driven by a force
inputs: {force: {unit: N, meaning: force on the cart}}
outputs:
  position: {value: x, unit: m, noise_std: 1e-4, meaning: position of the cart}
parameters:
  m: {value: 2.0, unit: kg, meaning: mass, estimate: true}
  f: {value: 0.5, unit: N s/m, meaning: viscous friction, estimate: true}
states:
  x: {der: v, unit: m, start: position}
  v: {der: (force - f*v - F_rail)/m, unit: m/s, start: "0[m/s]", size: 0.1}
elements:
  rail:
    meaning: rail
    sites: [{kind: piston_force, symbol: F_rail, signals: {speed: v, position: x}}]
law_sizes: {N: 1e-4, N s/m: 1e-6, m/s: 100, m: 10}
)yaml";

constexpr double kMass_kg = 3.1, kViscous_N_s_m = 1.5, kDry_N = 4.0, kDrag_N_s2_m2 = 3.0;

// Random steps of force; explicit Euler steps of 50 us: other code than the simulation's.
Recording ride(const std::string& name, unsigned seed) {
  constexpr double kSample_s = 0.01, kDuration_s = 20.0, kRamp_s = 0.05;
  constexpr int kSubsteps = 200, kSamples = static_cast<int>(kDuration_s / kSample_s);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> level(-12.0, 12.0), lasts(0.3, 1.2);
  std::normal_distribution<double> noise(0.0, 1e-4);
  Series force{"force", "N", 0.0, {}}, position{"position", "m", 0.0, {}};
  double from = 0.0, to = 0.0, since_s = 0.0, until_s = 0.4;
  for (int sample = 0; sample <= kSamples; ++sample) {
    const double t = sample * kSample_s;
    if (t >= until_s) {
      from = to;
      to = level(random);
      since_s = t;
      until_s = t + lasts(random);
    }
    force.values.push_back(from + (to - from) * std::min(1.0, (t - since_s) / kRamp_s));
  }
  Recording recording;
  recording.recording_id = name;
  double x = 0.0, v = 0.0;
  for (int sample = 0; sample < kSamples; ++sample) {
    recording.samples.time_s.push_back(sample * kSample_s);
    position.values.push_back(x + noise(random));
    const double u = force.values[static_cast<std::size_t>(sample)],
                 next = force.values[static_cast<std::size_t>(sample) + 1];
    for (int k = 0; k < kSubsteps; ++k) {
      const double lost = kViscous_N_s_m * v + kDry_N * std::tanh(v / 1e-3) + kDrag_N_s2_m2 * v * std::abs(v);
      v += kSample_s / kSubsteps * (u + (next - u) * k / kSubsteps - lost) / kMass_kg;
      x += kSample_s / kSubsteps * v;
    }
  }
  force.values.pop_back();
  recording.samples.channels = {std::move(force), std::move(position)};
  return recording;
}

AssetConfig cart() {
  const std::string file = ::testing::TempDir() + "cart.yaml";
  std::ofstream(file) << kCart;
  const auto plant = load_plant(file);
  if (!plant) ADD_FAILURE() << combine(plant.error()).describe();
  return nominal_asset("cart");
}

double largest_miss(const PlantSimulation& simulation, const SimulatedOutputs& outputs) {
  return (outputs.values - simulation.recorded()).cwiseAbs().maxCoeff();
}

/// The position is measured, its speed is not: both are held, within tau^2 times the acceleration that is lacking.
TEST(HeldStart, ASimulationThatIsHeldStaysNearTheRecording) {
  const auto simulation = PlantSimulation::create(cart(), ride("one", 1).samples);
  ASSERT_TRUE(simulation) << simulation.error().describe();
  const ModelValues values = (*simulation)->start();
  const auto free_run = (*simulation)->run(values, {}, {}, nullptr);
  const auto held = (*simulation)->run(values, {}, {.held_within_s = 0.1}, nullptr);
  ASSERT_TRUE(free_run && held);
  EXPECT_GT(largest_miss(**simulation, *free_run), 10.0);  // m
  EXPECT_LT(largest_miss(**simulation, *held), 0.1 * 0.1 * 12.0);
}

/// Of a held simulation too.
TEST(HeldStart, SensitivitiesOfAHeldSimulationAreItsDifferences) {
  const auto simulation = PlantSimulation::create(cart(), ride("one", 1).samples);
  ASSERT_TRUE(simulation) << simulation.error().describe();
  const SimulationOptions options{.relative_tolerance = 1e-9, .held_within_s = 0.1};
  ModelValues values = (*simulation)->start();
  for (const char* name : {"m", "f"}) {
    const FreeQuantity quantity = *(*simulation)->find(name);
    const auto here = (*simulation)->run(values, std::vector{quantity}, options, nullptr);
    const double value = quantity.in(values), step = 1e-4 * value;
    quantity.in(values) = value + step;
    const auto above = (*simulation)->run(values, {}, options, nullptr);
    quantity.in(values) = value - step;
    const auto below = (*simulation)->run(values, {}, options, nullptr);
    quantity.in(values) = value;
    ASSERT_TRUE(here && above && below);
    const Eigen::VectorXd difference = (above->values.col(0) - below->values.col(0)) / (2.0 * step),
                          sensitivity = here->sensitivities.col(0);
    EXPECT_LT((sensitivity - difference).norm(), 1e-4 * difference.norm()) << name;
  }
}

/// Free runs alone come to the same here where no time limit cuts them, in twice the time.
TEST(HeldStart, WhatAFarOffSimulationLacksIsNamed) {
  const auto found = mismatch::explain(cart(), std::vector{ride("one", 1), ride("two", 2), ride("three", 3)},
                                       std::vector{ride("four", 4)});
  ASSERT_TRUE(found) << found.error().describe();
  ASSERT_EQ(found->verdict, MismatchVerdict::mismatch) << found->summary;
  ASSERT_EQ(found->effects.size(), 2U) << found->summary;
  for (const mismatch::FoundEffect& effect : found->effects) {
    const bool drag = effect.what.id == "quadratic_drag";
    EXPECT_TRUE(drag || effect.what.id == "coulomb_friction") << found->summary;
    EXPECT_NEAR(effect.parameters.front().value, drag ? kDrag_N_s2_m2 : kDry_N, drag ? 0.15 : 0.1);
    EXPECT_FALSE(effect.parameters.front().at_bound);
  }
  EXPECT_LT(found->holdout.channels.front().rms_after, 1.5);
}

}  // namespace
}  // namespace sealwatch
