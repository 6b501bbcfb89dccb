// explain on a plant that is no valve actuator: a stage on flexures that a voice coil moves to both sides of zero, with
// what an engineer's model of it may lack. The recordings are made by semi-implicit Euler steps, which share nothing with
// the simulation.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <numbers>
#include <random>

#include "sealwatch/mismatch/explain.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "tests/unit/model/recording_for_tests.hpp"

namespace sealwatch {
namespace {

constexpr const char* kStage = R"yaml(name: voice_coil_stage
meaning: stage on flexures with a voice coil
inputs:
  voltage: {unit: V, course: held, role: drive, range: [-10, 10], meaning: voltage at the coil}
outputs:
  current: {value: i, unit: A, noise_std: 3.0e-3, meaning: coil current}
  position: {value: x, unit: m, noise_std: 1.0e-5, role: stroke, meaning: stage position}
parameters:
  M: {value: 0.5, unit: kg, meaning: moved mass}
  k: {value: 800, unit: N/m, min: 400, max: 1600, estimate: true, meaning: flexures}
  d: {value: 6, unit: N s/m, min: 1, max: 40, estimate: true, meaning: damping}
  K_F: {value: 8, unit: N/A, tolerance: 0.01, meaning: force constant}
  R: {value: 3, unit: ohm, min: 2, max: 5, estimate: true, meaning: coil resistance}
  L: {value: 4.0e-3, unit: H, tolerance: 0.05, meaning: coil inductance}
states:
  i: {der: (voltage - u_lost - R*i - K_F*v)/L, unit: A, start: "0[A]", own: false, size: 1, meaning: current}
  v: {der: (K_F*i - d*v - k*x - F)/M, unit: m/s, start: "0[m/s]", own: false, size: 0.05, meaning: speed}
  x: {der: v, unit: m, start: position, size: 5.0e-3, meaning: position}
elements:
  driver:
    meaning: voltage at the coil
    sites:
      - {kind: voltage_command, feeds: motor, symbol: u_lost, signals: {current: i, command: voltage}}
  stage:
    meaning: force on the stage
    sites:
      - {kind: piston_force, symbol: F, signals: {speed: v, position: x}}
law_sizes: {N: 8.0e-5, m: 0.08, m/s: 20, N s/m: 4.0e-6, V: 0.25, A: 0.2, s: 1}
)yaml";

struct Truth {
  double mass_kg = 0.5;
  std::function<double(double)> more_N = [](double) { return 0.0; };  ///< against +x, by position
};

Recording recorded(const std::string& name, const Truth& truth, double amplitude_V, unsigned seed) {
  constexpr double kStep_s = 2e-5, kSample_s = 5e-3, kDuration_s = 10.0;
  constexpr double kFlexures_N_m = 810.0, kDrag_N_s_m = 6.2, kForce_N_A = 8.0, kCoil_ohm = 3.05, kCoil_H = 4e-3;
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
  const std::array hertz = {0.3, 0.7, 1.3, 2.9, 5.3};
  std::array<double, hertz.size()> phases{};
  for (double& one : phases) one = phase(random);
  const auto command = [&](double t) {
    double sum = 0.0;
    for (std::size_t k = 0; k < hertz.size(); ++k)
      sum += std::sin(2.0 * std::numbers::pi * hertz[k] * t + phases[k]) - std::sin(phases[k]);
    return amplitude_V * sum;
  };
  Recording recording;
  recording.recording_id = name;
  Series voltage{"voltage", "V", 0.0, {}}, current{"current", "A", 3e-3, {}}, position{"position", "m", 1e-5, {}};
  double i = 0.0, v = 0.0, x = 0.0, held_V = 0.0;
  const long each = std::lround(kSample_s / kStep_s), steps = std::lround(kDuration_s / kStep_s);
  for (long step = 0; step <= steps; ++step) {
    const double t = static_cast<double>(step) * kStep_s;
    if (step % each == 0) {
      held_V = command(t);
      recording.samples.time_s.push_back(t);
      voltage.values.push_back(held_V);
      current.values.push_back(i + 3e-3 * noise(random));
      position.values.push_back(x + 1e-5 * noise(random));
    }
    i += kStep_s * (held_V - kCoil_ohm * i - kForce_N_A * v) / kCoil_H;
    v += kStep_s * (kForce_N_A * i - kDrag_N_s_m * v - kFlexures_N_m * x - truth.more_N(x)) / truth.mass_kg;
    x += kStep_s * v;
  }
  recording.samples.channels = {std::move(voltage), std::move(current), std::move(position)};
  return recording;
}

mismatch::Explanation explained(const Truth& truth) {
  const std::string file = ::testing::TempDir() + "voice_coil_stage.yaml";
  std::ofstream(file) << kStage;
  const auto plant = load_plant(file);
  if (!plant) throw std::runtime_error(combine(plant.error()).describe());
  const std::vector<Recording> fit = {recorded("small", truth, 0.25, 1), recorded("middle", truth, 0.5, 2),
                                      recorded("large", truth, 0.8, 3)};
  const auto found =
      mismatch::explain(nominal_asset((*plant)->name), fit, std::vector{recorded("apart", truth, 0.65, 4)});
  if (!found) throw std::runtime_error(found.error().describe());
  return *found;
}

/// The flexures' stiffness is fitted and takes part of it, another part in each recording.
TEST(ForeignStage, ASpringThatHardensIsFoundBesideAStiffnessThatIsFitted) {
  const mismatch::Explanation found = explained({.more_N = [](double x) { return 4e6 * x * x * x; }});
  ASSERT_EQ(found.verdict, MismatchVerdict::mismatch) << found.summary;
  ASSERT_EQ(found.effects.size(), 1U) << found.summary;
  EXPECT_EQ(found.effects[0].what.id, "spring_load") << found.summary;
  EXPECT_NEAR(found.effects[0].parameters.at(1).value, 3.0, 0.15) << found.effects[0].parameters.at(1).name;
}

/// No catalogue's actuator has a position below zero.
TEST(ForeignStage, AnObstacleBelowZeroIsFoundWhereItIs) {
  const mismatch::Explanation found =
      explained({.more_N = [](double x) { return 0.15 * std::exp(-std::pow((x + 3e-3) / 1.4e-3, 2)); }});
  ASSERT_EQ(found.verdict, MismatchVerdict::mismatch) << found.summary;
  ASSERT_EQ(found.effects.size(), 1U) << found.summary;
  EXPECT_EQ(found.effects[0].what.id, "position_dependent_load") << found.summary;
  EXPECT_NEAR(found.effects[0].parameters.at(1).value, -3e-3, 2e-4) << found.effects[0].parameters.at(1).name;
}

/// All forces by a twentieth larger, or all currents read by as much too small: nobody can tell.
TEST(ForeignStage, AWrongMassIsNotTakenForASensorThatIsOff) {
  const mismatch::Explanation found = explained({.mass_kg = 0.525});
  EXPECT_EQ(found.verdict, MismatchVerdict::undetermined) << found.summary;
  EXPECT_TRUE(found.effects.empty()) << found.summary;
  const auto is_mass = [](const std::vector<mismatch::AssetValue>& values) {
    return values.size() == 1 && values.front().name == "M";
  };
  const auto mass = std::ranges::find_if(found.asset_values, is_mass);
  ASSERT_NE(mass, found.asset_values.end()) << found.summary;
  EXPECT_NEAR(mass->front().fitted, 0.525, 0.005);
  EXPECT_NE(found.summary.find("sensor gain at the sensor of current"), std::string::npos) << found.summary;
}

}  // namespace
}  // namespace sealwatch
