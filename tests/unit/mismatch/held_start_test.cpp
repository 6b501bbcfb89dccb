// explain where the simulation from the model's values is far off: a cart that no spring pulls back, so that what it lacks
// adds up over the whole recording; and a table on springs that swings many times a second, out of step with it.
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

constexpr const char* kTable = R"yaml(name: table
meaning: vibration table on springs
inputs: {force: {unit: N, meaning: force of the shaker}}
outputs:
  position: {value: x, unit: m, noise_std: 5e-6, meaning: displacement of the table}
parameters:
  m: {value: 33, unit: kg, meaning: mass, estimate: true}
  c: {value: 250, unit: N s/m, meaning: damping, estimate: true}
  k: {value: 5.0e+4, unit: N/m, meaning: stiffness of the springs, estimate: true}
states:
  x: {der: v, unit: m, start: position}
  v: {der: (force - c*v - k*x - F_springs)/m, unit: m/s, start: "0[m/s]", size: 0.1, own: false}
elements:
  springs:
    meaning: springs of the table
    sites: [{kind: piston_force, symbol: F_springs, signals: {speed: v, position: x}}]
law_sizes: {N: 2.5e-3, N s/m: 1.25e-4, m: 0.125, m/s: 100}
)yaml";

/// A mass with what takes its force at a position and a speed.
struct Machine {
  double mass_kg, largest_N, noise_m, sample_s, duration_s, lasts_s;
  double (*lost_N)(double x, double v);
};

constexpr Machine kTheCart = {kMass_kg, 12.0, 1e-4, 0.01, 20.0, 1.2, [](double, double v) {
                                return kViscous_N_s_m * v + kDry_N * std::tanh(v / 1e-3) +
                                       kDrag_N_s2_m2 * v * std::abs(v);
                              }};
constexpr double kHardening_N = 50e3;  // at 50 mm
constexpr Machine kTheTable = {35.0, 220.0, 5e-6, 0.004, 8.0, 0.4, [](double x, double v) {
                                 return 220.0 * v + 48e3 * x + kHardening_N * std::pow(x / 0.05, 3);
                               }};

// Random steps of force, or with `sweep_N` a sweep from 0.5 to 12 Hz; explicit Euler steps of 50 us: other code than the
// simulation's.
Recording ride(const std::string& name, unsigned seed, const Machine& machine = kTheCart, double sweep_N = 0.0) {
  constexpr double kRamp_s = 0.05, kStep_s = 50e-6;
  const int substeps = static_cast<int>(std::lround(machine.sample_s / kStep_s)),
            samples = static_cast<int>(std::lround(machine.duration_s / machine.sample_s));
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> level(-machine.largest_N, machine.largest_N),
      lasts(0.25 * machine.lasts_s, machine.lasts_s);
  std::normal_distribution<double> noise(0.0, machine.noise_m);
  Series force{"force", "N", 0.0, {}}, position{"position", "m", 0.0, {}};
  double from = 0.0, to = 0.0, since_s = 0.0, until_s = 0.4;
  for (int sample = 0; sample <= samples; ++sample) {
    const double t = sample * machine.sample_s;
    if (t >= until_s) {
      from = to;
      to = level(random);
      since_s = t;
      until_s = t + lasts(random);
    }
    const double steps = from + (to - from) * std::min(1.0, (t - since_s) / kRamp_s),
                 turns = 0.5 * t + 0.5 * 11.5 * t * t / machine.duration_s;
    force.values.push_back(sweep_N > 0.0 ? sweep_N * std::sin(2.0 * M_PI * turns) : steps);
  }
  Recording recording;
  recording.recording_id = name;
  double x = 0.0, v = 0.0;
  for (int sample = 0; sample < samples; ++sample) {
    recording.samples.time_s.push_back(sample * machine.sample_s);
    position.values.push_back(x + noise(random));
    const double u = force.values[static_cast<std::size_t>(sample)],
                 next = force.values[static_cast<std::size_t>(sample) + 1];
    for (int k = 0; k < substeps; ++k) {
      v += kStep_s * (u + (next - u) * k / substeps - machine.lost_N(x, v)) / machine.mass_kg;
      x += kStep_s * v;
    }
  }
  force.values.pop_back();
  recording.samples.channels = {std::move(force), std::move(position)};
  return recording;
}

AssetConfig asset_of(const std::string& name, const char* text) {
  const std::string file = ::testing::TempDir() + name + ".yaml";
  std::ofstream(file) << text;
  const auto plant = load_plant(file);
  if (!plant) ADD_FAILURE() << combine(plant.error()).describe();
  return nominal_asset(name);
}
AssetConfig cart() { return asset_of("cart", kCart); }

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

/// Its springs harden, a third of their force at the largest displacement: held within tens of samples it is still out of
/// step, and free runs alone name a load around one position that leaves a hundred times the noise.
TEST(HeldStart, WhatAFastPlantLacksIsNamed) {
  const auto found = mismatch::explain(asset_of("table", kTable),
                                       std::vector{ride("one", 1, kTheTable, 60.0), ride("two", 2, kTheTable, 150.0)},
                                       std::vector{ride("three", 3, kTheTable, 110.0)});
  ASSERT_TRUE(found) << found.error().describe();
  ASSERT_EQ(found->verdict, MismatchVerdict::mismatch) << found->summary;
  ASSERT_EQ(found->effects.size(), 1U) << found->summary;
  const mismatch::FoundEffect& spring = found->effects.front();
  EXPECT_EQ(spring.what.id, "spring_load") << found->summary;
  const double at_its_size = kHardening_N * std::pow(0.125, 3);  // law_sizes of the table: 6.25 mm
  EXPECT_NEAR(spring.parameters.at(0).value, at_its_size, 0.02 * at_its_size);
  EXPECT_NEAR(spring.parameters.at(1).value, 3.0, 0.02);
  EXPECT_LT(found->holdout.channels.front().rms_after, 1.5);
}

}  // namespace
}  // namespace sealwatch
