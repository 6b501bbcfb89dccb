// explain on plants that are no valve actuators, with what an engineer's model of them may lack: a stage on flexures that
// a voice coil moves to both sides of zero, and a quarter of a car on a shaker. The recordings are made by steps of Euler
// and of Runge and Kutta that share nothing with the simulation.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

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
  EXPECT_NE(found.summary.find("sensor gain of current"), std::string::npos) << found.summary;
}

constexpr const char* kQuarterCar = R"yaml(name: quarter_car
meaning: two masses on a shaker
inputs:
  road: {unit: m, course: band_limited, meaning: displacement of the shaker}
outputs:
  body_acceleration: {value: -(k_s*d + c_s*w + F_s)/m_s, unit: m/s2, noise_std: 0.04, meaning: accelerometer}
  deflection: {value: d, unit: m, noise_std: 1.0e-4, meaning: travel of the suspension}
parameters:
  m_s: {value: 250, unit: kg, tolerance: 0.01, meaning: body mass}
  m_u: {value: 40, unit: kg, tolerance: 0.01, meaning: wheel mass}
  k_s: {value: 16000, unit: N/m, min: 8000, max: 32000, estimate: true, meaning: suspension spring}
  c_s: {value: 1200, unit: N s/m, min: 400, max: 4000, estimate: true, meaning: damper}
  k_t: {value: 180000, unit: N/m, min: 90000, max: 360000, estimate: true, meaning: tyre}
definitions:
  d: z_s - z_u
  w: v_s - v_u
states:
  z_s: {der: v_s, unit: m, start: "0[m]", own: false, size: 0.02, meaning: body}
  v_s: {der: -(k_s*d + c_s*w + F_s)/m_s, unit: m/s, start: "0[m/s]", own: false, size: 0.2, meaning: body speed}
  z_u: {der: v_u, unit: m, start: "0[m]", own: false, size: 0.02, meaning: wheel}
  v_u:
    der: (k_s*d + c_s*w + F_s - k_t*(z_u - road) - F_t)/m_u
    unit: m/s
    start: "0[m/s]"
    own: false
    size: 0.5
    meaning: wheel speed
elements:
  suspension:
    meaning: force of spring and damper
    sites:
      - {kind: piston_force, symbol: F_s, signals: {speed: w, position: d}}
  tyre:
    meaning: force of the tyre
    sites:
      - {kind: piston_force, symbol: F_t, signals: {position: z_u - road}}
law_sizes: {N: 8.0e-3, m: 0.5, m/s: 200, N s/m: 6.0e-4, s: 1}
)yaml";

/// A spring with a cubic term, in steps of Runge and Kutta; each course of the road is a sum of sines that begins at rest.
Recording driven(const std::string& name, const std::vector<std::array<double, 2>>& hertz_and_mm, unsigned seed) {
  constexpr double kSample_s = 2.5e-3, kDuration_s = 16.0, kBody_kg = 252.0, kWheel_kg = 40.4;
  constexpr double kSpring_N_m = 16150.0, kDamper_N_s_m = 1212.0, kTyre_N_m = 181500.0, kCubic_N_m3 = 8e5;
  constexpr int kStepsOfSample = 5;
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::uniform_real_distribution<double> any_phase(0.0, 2.0 * std::numbers::pi);
  std::vector<double> phases;
  for (std::size_t k = 0; k < hertz_and_mm.size(); ++k) phases.push_back(any_phase(random));
  const auto road_m = [&](double t) {
    double sum = 0.0;
    for (std::size_t k = 0; k < phases.size(); ++k)
      sum += 1e-3 * hertz_and_mm[k][1] * std::sin(2.0 * std::numbers::pi * hertz_and_mm[k][0] * t + phases[k]);
    return sum * (1.0 - std::exp(-std::pow(t / 0.4, 2)));
  };
  using State = std::array<double, 4>;
  const auto suspension_N = [](const State& of) {
    const double d = of[0] - of[2];
    return kSpring_N_m * d + kDamper_N_s_m * (of[1] - of[3]) + kCubic_N_m3 * d * d * d;
  };
  const auto slope = [&](double t, const State& of) {
    const double F = suspension_N(of);
    return State{of[1], -F / kBody_kg, of[3], (F - kTyre_N_m * (of[2] - road_m(t))) / kWheel_kg};
  };
  const auto along = [](const State& from, double h, const State& rate) {
    State there = from;
    for (std::size_t k = 0; k < there.size(); ++k) there[k] += h * rate[k];
    return there;
  };
  Recording recording;
  recording.recording_id = name;
  Series road{"road", "m", 0.0, {}}, acceleration{"body_acceleration", "m/s2", 0.04, {}},
      deflection{"deflection", "m", 1e-4, {}};
  State y{};
  for (int row = 0; row * kSample_s < kDuration_s; ++row) {
    const double t = row * kSample_s, h = kSample_s / kStepsOfSample;
    recording.samples.time_s.push_back(t);
    road.values.push_back(road_m(t));
    acceleration.values.push_back(-suspension_N(y) / kBody_kg + 0.04 * noise(random));
    deflection.values.push_back(y[0] - y[2] + 1e-4 * noise(random));
    for (int k = 0; k < kStepsOfSample; ++k) {
      const double at = t + k * h;
      const State a = slope(at, y), b = slope(at + 0.5 * h, along(y, 0.5 * h, a)),
                  c = slope(at + 0.5 * h, along(y, 0.5 * h, b)), d = slope(at + h, along(y, h, c));
      for (std::size_t j = 0; j < y.size(); ++j) y[j] += h / 6.0 * (a[j] + 2.0 * b[j] + 2.0 * c[j] + d[j]);
    }
  }
  recording.samples.channels = {std::move(road), std::move(acceleration), std::move(deflection)};
  return recording;
}

/// The stiffness is fitted and takes a part of it, another part in each recording: it is no change between the tests.
TEST(ForeignCar, ASpringThatHardensIsFoundBesideAStiffnessThatIsFitted) {
  const std::string file = ::testing::TempDir() + "quarter_car.yaml";
  std::ofstream(file) << kQuarterCar;
  const auto plant = load_plant(file);
  ASSERT_TRUE(plant) << combine(plant.error()).describe();
  const std::vector<Recording> fit = {driven("rough", {{0.6, 8}, {1.2, 9}, {2.1, 3}, {4.3, 1.2}, {9.7, 0.6}}, 1),
                                      driven("rolling", {{1.1, 9}, {1.35, 8}, {3.2, 2}, {7.1, 0.8}, {12, 0.5}}, 2),
                                      driven("beat", {{0.9, 6}, {1.3, 16}}, 3),
                                      driven("slow", {{0.4, 12}, {1.7, 7}, {2.9, 3}, {5.7, 1.5}, {11, 0.5}}, 4)};
  const auto found =
      mismatch::explain(nominal_asset((*plant)->name), fit,
                        std::vector{driven("apart", {{0.8, 7}, {1.25, 8}, {1.6, 6}, {6.1, 1}, {10.3, 0.6}}, 5)});
  ASSERT_TRUE(found) << found.error().describe();
  ASSERT_EQ(found->verdict, MismatchVerdict::mismatch) << found->summary;
  ASSERT_EQ(found->effects.size(), 1U) << found->summary;
  EXPECT_EQ(found->effects[0].what.id, "spring_load") << found->summary;
  EXPECT_NEAR(found->effects[0].parameters.at(1).value, 3.0, 0.15) << found->effects[0].parameters.at(1).name;
}

}  // namespace
}  // namespace sealwatch
