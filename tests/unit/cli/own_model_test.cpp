// Plants as a user writes them at first: values with which nothing can be simulated, an input that a controller holds,
// a logger that pauses.
#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "sealwatch/estimation/actuator_fit.hpp"
#include "sealwatch/mismatch/explain.hpp"
#include "sealwatch/model/simulation.hpp"
#include "services/common/estimation/runaway.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "tests/unit/runtime/yaml_place.hpp"

namespace sealwatch::cli {
namespace {

AssetConfig asset_of(const testing::YamlPlace& place, const std::string& plant, const std::string& asset) {
  place.write("plant.yaml", plant);
  auto loaded = load_asset(place.write("asset.yaml", "asset_id: U-1\nmodel: plant.yaml\n" + asset));
  EXPECT_TRUE(loaded) << loaded.error().describe();
  return std::move(*loaded);
}

/// Noise of the channels on what the asset gives.
TimeSeries recorded_by(const AssetConfig& truth, TimeSeries samples, unsigned seed) {
  const auto simulation = PlantSimulation::create(truth, samples).value();
  const auto outputs = simulation->run(simulation->start(), {}, {.maximum_steps = 10000000}).value();
  std::mt19937 random(seed);
  for (std::size_t c = 0; c < simulation->channels().size(); ++c)
    for (Series& channel : samples.channels)
      if (channel.name == simulation->channels()[c]) {
        std::normal_distribution<double> noise(0.0, channel.noise_std);
        for (std::size_t k = 0; k < channel.values.size(); ++k)
          channel.values[k] =
              outputs.values(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(c)) + noise(random);
      }
  return samples;
}

double value_of(const FitReport& report, const std::string& name) {
  const auto found = std::ranges::find(report.parameters, name, &EstimatedParameter::name);
  return found == report.parameters.end() ? 0.0 : found->value;
}

constexpr const char* kMass = R"yaml(name: swinging_mass
meaning: a mass on a spring that is hardly damped
inputs:
  u: {unit: N, meaning: force}
outputs:
  position: {value: x, unit: m, noise_std: 1.0e-4, meaning: where it is}
parameters:
  M: {value: 2.0, unit: kg, meaning: mass}
  k: {value: 50.0, unit: N/m, min: -1.0e4, max: 1.0e4, meaning: stiffness, estimate: true}
  c: {value: 0.5, unit: N s/m, min: 0.01, max: 50, meaning: damping, estimate: true}
states:
  x: {der: v, unit: m, start: position}
  v: {der: (u - k*x - c*v - lost)/M, unit: m/s, start: 0, own: false, size: 1.0}
elements:
  mass:
    meaning: forces on the mass
    sites:
      - {kind: piston_force, symbol: lost, signals: {speed: v, position: x}}
law_sizes: {N: 1e-3, m: 1, m/s: 1, N s/m: 1e-3}
)yaml";

/// The same under another name, as a process knows each plant once.
std::string mass_named(const std::string& name) {
  return std::string(kMass).replace(std::string("name: ").size(), std::string("swinging_mass").size(), name);
}

TimeSeries pushes() {
  TimeSeries samples;
  Series force{"u", "N", 0.0, {}}, position{"position", "m", 1e-4, {}};
  for (int k = 0; k < 1500; ++k) {
    const double t = 0.02 * k;
    samples.time_s.push_back(t);
    force.values.push_back(2.0 * std::sin(0.8 * t) + std::sin(2.9 * t) + (k > 700 ? 1.0 : 0.0));
    position.values.push_back(0.0);
  }
  samples.channels = {force, position};
  return samples;
}

// With a stiffness of the wrong sign the mass runs away within seconds: no slope leads back from there.
TEST(OwnModel, AModelThatExplodesAtItsFirstValuesIsFittedFromPieces) {
  const testing::YamlPlace place;
  const AssetConfig truth = asset_of(place, kMass, "");
  const TimeSeries recorded = recorded_by(truth, pushes(), 3);
  AssetConfig guess = truth;
  guess.parameters.at("k") = {.value = -30.0, .min = -1e4, .max = 1e4, .estimate = true};
  guess.parameters.at("c").value = 2.0;
  ActuatorFitOptions options;
  const JointFit fit = fit_actuator(guess, std::span(&recorded, 1), options);
  EXPECT_TRUE(fit.report.admissible) << (fit.report.reasons.empty() ? "" : fit.report.reasons.front());
  EXPECT_NEAR(value_of(fit.report, "k"), 50.0, 0.05);
  EXPECT_NEAR(value_of(fit.report, "c"), 0.5, 0.01);
  options.cut_into_pieces = false;
  EXPECT_FALSE(fit_actuator(guess, std::span(&recorded, 1), options).report.admissible) << "or this tells nothing";
}

// Every jump of a held input starts the integration anew: that is no explosion.
TEST(OwnModel, AnInputThatIsHeldFromSampleToSampleMayTakeManySteps) {
  const testing::YamlPlace place;
  std::string motor = R"yaml(name: held_motor
meaning: DC motor and a drum on a flexible shaft
inputs:
  u: {unit: V, course: held, meaning: armature voltage}
outputs:
  current: {value: i, unit: A, noise_std: 0.01, meaning: armature current}
  speed:   {value: w, unit: rad/s, noise_std: 0.2, meaning: speed of the motor}
parameters:
  R: {value: 1.2, unit: ohm, meaning: resistance, estimate: true}
  L: {value: 2.0e-3, unit: H, meaning: inductance}
  K: {value: 0.06, unit: V s/rad, meaning: motor constant}
  J: {value: 8.0e-5, unit: kg m2, meaning: inertia of the motor}
  k: {value: 0.6, unit: N m/rad, meaning: stiffness of the shaft}
  d: {value: 5.0e-4, unit: N m s/rad, meaning: damping of the shaft}
  D: {value: 2.0e-4, unit: kg m2, meaning: inertia of the drum}
states:
  i: {der: (u - R*i - K*w)/L, unit: A, start: current}
  w: {der: (K*i - k*twist - d*(w - w_d))/J, unit: rad/s, start: speed}
  twist: {der: w - w_d, unit: rad, start: 0, size: 0.1, own: false}
  w_d: {der: (k*twist + d*(w - w_d))/D, unit: rad/s, start: speed, size: 10, own: false}
elements: {}
law_sizes: {}
)yaml";
  const AssetConfig asset = asset_of(place, motor, "");
  TimeSeries samples;
  Series voltage{"u", "V", 0.0, {}}, current{"current", "A", 0.01, {}}, speed{"speed", "rad/s", 0.2, {}};
  for (int k = 0; k < 3000; ++k) {
    const double t = 0.002 * k;
    samples.time_s.push_back(t);
    voltage.values.push_back(10.0 * std::sin(3.0 * t) + 5.0 * std::sin(14.0 * t));
    current.values.push_back(0.0);
    speed.values.push_back(0.0);
  }
  samples.channels = {voltage, current, speed};
  const TimeSeries recorded = recorded_by(asset, samples, 5);
  AssetConfig guess = asset;
  guess.parameters.at("R").value = 1.5;
  const JointFit fit = fit_actuator(guess, std::span(&recorded, 1), {});
  EXPECT_TRUE(fit.report.admissible) << (fit.report.reasons.empty() ? "" : fit.report.reasons.front());
  EXPECT_NEAR(value_of(fit.report, "R"), 1.2, 2e-3);
}

// A logger that keeps still while nothing happens: the mean distance of its samples says nothing of its strokes.
TEST(OwnModel, StrokesBetweenLongPausesAreNotSteppedOver) {
  const testing::YamlPlace place;
  const AssetConfig asset = asset_of(place, mass_named("pausing_mass"), "");
  TimeSeries samples;
  Series force{"u", "N", 0.0, {}}, position{"position", "m", 1e-4, {}};
  const auto at = [&](double t, double push) {
    samples.time_s.push_back(t);
    force.values.push_back(push);
    position.values.push_back(0.0);
  };
  for (int minute = 0; minute < 40; ++minute) {
    at(60.0 * minute, 0.0);
    const bool strokes = minute % 10 == 5;  // a push of half a second, five seconds later
    for (int k = 1; strokes && k < 500; ++k)
      at(60.0 * minute + 0.02 * k, k > 250 && k < 282 ? 5.0 * std::pow(std::sin(0.1 * (k - 250)), 2) : 0.0);
  }
  samples.channels = {force, position};
  const TimeSeries recorded = recorded_by(asset, samples, 3);
  AssetConfig guess = asset;
  guess.parameters.at("k").value = 47.0;
  const JointFit fit = fit_actuator(guess, std::span(&recorded, 1), {});
  EXPECT_TRUE(fit.report.admissible) << (fit.report.reasons.empty() ? "" : fit.report.reasons.front());
  EXPECT_NEAR(value_of(fit.report, "k"), 50.0, 0.1);
}

// A channel that never moves shows no noise, and a misfit without noise says nothing.
TEST(OwnModel, WithoutNoiseNothingIsAdmissible) {
  const testing::YamlPlace place;
  std::string silent = mass_named("silent_mass");
  silent.replace(silent.find(", noise_std: 1.0e-4"), std::string(", noise_std: 1.0e-4").size(), "");
  silent.replace(silent.find("start: position"), std::string("start: position").size(), "start: position, size: 0.1");
  const AssetConfig asset = asset_of(place, silent, "");
  TimeSeries still = pushes();
  still.channels[1].noise_std = 0.0;
  const JointFit fit = fit_actuator(asset, std::span(&still, 1), {});
  EXPECT_FALSE(fit.report.admissible);
  EXPECT_THAT(fit.report.reasons, ::testing::Contains(::testing::HasSubstr("noise_std")));
}

constexpr const char* kPendulum = R"yaml(name: standing_pendulum
meaning: a pendulum that stands on a fixed pivot
inputs:
  u: {unit: N m, meaning: torque}
outputs:
  angle: {value: phi, unit: rad, noise_std: 1.0e-4, meaning: from upright}
parameters:
  g: {value: GRAVITY, unit: 1/s2, min: -30, max: 30, meaning: gravity over length}
  d: {value: 0.2, unit: 1/s, meaning: friction of the bearing}
  J: {value: 0.1, unit: kg m2, meaning: inertia}
states:
  phi: {der: w, unit: rad, start: angle}
  w: {der: g*sin(phi) - d*w + u/J, unit: rad/s, start: 0, size: 1.0}
elements: {}
law_sizes: {}
)yaml";

// What stands falls, whatever the parameters: a controller held the machine, and its torque alone cannot. One that hangs
// swings, and two integrators in a row let errors grow as the time does: both are as well followed as any.
TEST(OwnModel, APlantThatRunsAwayIsTold) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 1.0e-4);
  TimeSeries samples;
  Series torque{.name = "u", .unit = "N m", .values = {}};
  Series angle{.name = "angle", .unit = "rad", .noise_std = 1.0e-4, .values = {}};
  for (int k = 0; k < 801; ++k) {
    samples.time_s.push_back(0.01 * k);
    torque.values.push_back(0.01 * std::sin(0.02 * k));
    angle.values.push_back(0.02 * std::cos(0.03 * k) + noise(random));
  }
  samples.channels = {torque, angle};
  const auto found_with = [&](const std::string& name, const std::string& gravity) {
    std::string plant = kPendulum;
    plant.replace(plant.find("GRAVITY"), 7, gravity);
    plant.replace(plant.find("standing"), 8, name);
    const testing::YamlPlace place;
    return find_runaway(asset_of(place, plant, ""), samples);
  };
  const auto standing = found_with("standing", "20");
  ASSERT_TRUE(standing);
  EXPECT_EQ(standing->channel, "angle");
  EXPECT_GT(standing->decades, 8.0) << "exp(4.4 t) over 8 s are 15";
  EXPECT_FALSE(found_with("hanging", "-20"));
  EXPECT_FALSE(found_with("weightless", "0"));
}

/// The pendulum of `kPendulum` with gravity 20, held by a controller of `stiffness` that moves it to and fro.
Recording held_pendulum(double stiffness, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 1.0e-4);
  Recording recording;
  recording.asset_id = "U-1";
  recording.file = recording.recording_id = recording.content_hash = std::to_string(seed);
  Series torque{.name = "u", .unit = "N m", .values = {}};
  Series angle{.name = "angle", .unit = "rad", .noise_std = 1.0e-4, .values = {}};
  constexpr double kInertia = 0.1, kStep = 1.0e-4;
  double phi = 0.0, w = 0.0;
  for (int k = 0; k < 80001; ++k) {
    const double wanted = 0.1 * std::sin(1.5 * kStep * k);
    const double u = kInertia * (stiffness * (wanted - phi) - 10.0 * w);
    if (k % 100 == 0) {
      recording.samples.time_s.push_back(kStep * k);
      torque.values.push_back(u);
      angle.values.push_back(phi + noise(random));
    }
    w += kStep * (20.0 * std::sin(phi) - 0.2 * w + u / kInertia);
    phi += kStep * w;
  }
  recording.samples.channels = {torque, angle};
  return recording;
}

// Its equations are right: whatever is named in them or in the recorded torque would be a wrong name.
TEST(OwnModel, NothingIsBlamedWhereThePlantRunsAway) {
  const testing::YamlPlace place;
  std::string plant = kPendulum;
  plant.replace(plant.find("GRAVITY"), 7, "20");
  plant.replace(plant.find("standing"), 8, "held");
  const AssetConfig asset = asset_of(place, plant, "");
  const std::vector<Recording> fit = {held_pendulum(60.0, 1)}, holdout = {held_pendulum(90.0, 2)};
  const auto found = mismatch::explain(asset, fit, holdout);
  ASSERT_TRUE(found) << found.error().describe();
  EXPECT_EQ(found->verdict, mismatch::Verdict::undetermined);
  EXPECT_THAT(found->summary, ::testing::HasSubstr("runs away by itself: an error in the start of angle grows 10^"));
  EXPECT_THAT(found->next_test, ::testing::HasSubstr("its controller, into the plant's equations"));
  EXPECT_TRUE(found->location.empty()) << found->location.front().element << ": " << found->summary;
}

}  // namespace
}  // namespace sealwatch::cli
