// explain on plants that are written as text (config/plants): the built-in plant's verdict on the same recordings, and
// the literature's naive models against real recordings.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>

#include "sealwatch/mismatch/explain.hpp"
#include "services/common/runtime/asset_file.hpp"
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

// Every explanation of that effect that the recordings cannot exclude.
std::vector<mismatch::LawAt> explanations_of(const mismatch::FoundEffect& effect) {
  std::vector<mismatch::LawAt> all = effect.indistinguishable;
  all.push_back(effect.what);
  return all;
}

TEST(TextPlants, ExplainTheTanksAsTheBuiltInPlantDoes) {
  if (!recorded("cascaded_tanks")) GTEST_SKIP() << "no public recordings";
  const std::vector<Recording> one = {recording_of("cascaded_tanks/train.csv")};
  const auto native = mismatch::explain(nominal_asset("cascaded_tanks"), one, {});
  const auto text = mismatch::explain(asset_of_file("cascaded_tanks"), one, {});
  ASSERT_TRUE(native) << native.error().describe();
  ASSERT_TRUE(text) << text.error().describe();
  EXPECT_EQ(native->verdict, text->verdict) << native->summary << "\n" << text->summary;
  // Which of several that predict alike comes first, and how many, is the integrator's last digits: what one names, or
  // cannot tell from it, the other names.
  for (const auto& [one_of, other] : {std::pair{&*native, &*text}, std::pair{&*text, &*native}})
    for (const mismatch::FoundEffect& effect : one_of->effects)
      EXPECT_TRUE(std::ranges::any_of(explanations_of(effect), [&](const auto& law) { return names(*other, law.id); }))
          << effect.what.id << ": " << other->summary;
  EXPECT_EQ(native->location.at(0).element, text->location.at(0).element);
  for (const mismatch::Explanation* found : {&*native, &*text}) {
    const mismatch::ChannelComparison& level = found->holdout.channels.at(0);
    EXPECT_LT(level.rms_after, 0.8 * level.rms_before) << found->summary;
  }
}

/// The law of that id, whose free run misses a piece that took no part by less than 0.6 mV; linear models by 7 mV.
mismatch::FoundEffect expect_spring_and_offset(const AssetConfig& asset, const std::string& id) {
  constexpr std::size_t kRows = 2000;  // as many say as much
  constexpr double kGoal = 6e-4;       // V
  std::vector<Recording> fit = {recording_of("silverbox/multisine_1.csv")};
  std::vector<Recording> holdout = {recording_of("silverbox/multisine_3.csv")};
  for (std::vector<Recording>* all : {&fit, &holdout}) {
    all->front().samples.time_s.resize(kRows);
    for (Series& series : all->front().samples.channels) series.values.resize(kRows);
  }
  const auto found = mismatch::explain(asset, fit, holdout);
  if (!found) throw std::runtime_error(found.error().describe());
  EXPECT_EQ(found->verdict, MismatchVerdict::mismatch) << found->summary;
  EXPECT_TRUE(names(*found, "constant_force")) << found->summary;
  const mismatch::ChannelComparison& y = found->holdout.channels.at(0);
  EXPECT_LT(y.rms_after, 0.1 * y.rms_before) << found->summary;
  EXPECT_LT(y.rms_after * found->recordings.back().recorded.channels.at(0).noise_std, kGoal);
  const auto law = std::ranges::find(found->effects, id, [](const auto& effect) { return effect.what.id; });
  if (law == found->effects.end()) throw std::runtime_error(found->summary);
  return *law;
}

/// A closed form of the catalogue has the spring's equation. It takes little without the offset, so that listed laws that
/// imitate a part of it come first.
TEST(TextPlants, FindTheSilverboxsSpringAndOffset) {
  if (!recorded("silverbox")) GTEST_SKIP() << "no public recordings";
  const mismatch::FoundEffect spring = expect_spring_and_offset(asset_of_file("silverbox"), "spring_load");
  EXPECT_NEAR(spring.parameters.at(1).value, 3.0, 0.15) << spring.parameters.at(1).name;
}

/// A law of the plant's own is tried beside those of the catalogue.
TEST(TextPlants, FindTheSilverboxsSpringByALawOfItsOwn) {
  if (!recorded("silverbox")) GTEST_SKIP() << "no public recordings";
  std::ifstream naive(SEALWATCH_SOURCE_DIR "/config/plants/silverbox.yaml");
  std::string text((std::istreambuf_iterator<char>(naive)), {});
  text.replace(text.find("name: silverbox"), 15, "name: duffing_silverbox");
  text += R"yaml(
laws:
  - id: duffing_spring
    element: piston
    equation: k_3 * position^3
    meaning: a spring that grows harder with its way
    parameters:
      k_3: {unit: N/m3, usual: 50, matters: 10, min: -1.0e4, max: 1.0e4, strength: true, meaning: hardening}
)yaml";
  const std::string file = testing::TempDir() + "duffing_silverbox.yaml";
  std::ofstream(file) << text;
  const auto plant = load_plant(file);
  ASSERT_TRUE(plant) << combine(plant.error()).describe();
  expect_spring_and_offset(nominal_asset((*plant)->name), "duffing_spring");
}

/// The positioner of config/plants/spring_return.yaml, a thousand times as strong.
constexpr double kTimes = 1000.0;
std::string large_positioner() {
  return R"yaml(name: large_positioner
meaning: valve positioner with a return spring
inputs: {drive_voltage: {unit: V, meaning: command u to the drive}}
outputs: {position: {value: x, unit: m, noise_std: 1.0e-5, meaning: stem position}}
parameters:
  M:   {value: 20.0e3, unit: kg,    meaning: moved mass, estimate: true}
  F_v: {value: 2.0e6,  unit: N s/m, meaning: viscous friction, estimate: true}
  k_s: {value: 1.0e7,  unit: N/m,   meaning: stiffness of the return spring, estimate: true}
  k_F: {value: 100.0e3, unit: N/V,  meaning: force of the drive per voltage}
states:
  x: {der: v, unit: m, start: position, meaning: stem position}
  v: {der: (k_F*drive_voltage - F_v*v - k_s*x - F_missing) / M, unit: m/s, start: "0[m/s]", own: false, size: 0.1}
elements:
  piston:
    meaning: force on the stem
    sites:
      - {kind: piston_force, symbol: F_missing, signals: {speed: v, position: x}}
law_sizes: {N: 20, m: 1.0, m/s: 10.0, N/m: 20, N/m2: 20, N s/m: 10, N s2/m2: 1.0}
)yaml";
}

/// Dry friction of `friction_N` in explicit Euler steps of 5 us: other code than the simulation's.
Recording large_stroke(const std::string& name, double period_s, double friction_N, unsigned seed) {
  constexpr double kStep_s = 5e-6, kSample_s = 0.01, kDuration_s = 12.0, kReversal = 1e-3;
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 1e-5);
  Recording recording;
  recording.recording_id = name;
  Series voltage{"drive_voltage", "V", 0.0, {}}, position{"position", "m", 0.0, {}};
  const auto command = [&](double t) { return 4.0 * (1.0 - std::cos(2.0 * std::numbers::pi * t / period_s)); };
  double x = 0.0, v = 0.0;
  for (int sample = 0; sample * kSample_s <= kDuration_s; ++sample) {
    recording.samples.time_s.push_back(sample * kSample_s);
    voltage.values.push_back(command(sample * kSample_s));
    position.values.push_back(x + noise(random));
    for (int k = 0; k < static_cast<int>(std::lround(kSample_s / kStep_s)); ++k) {
      const double force = kTimes * (100.0 * command(sample * kSample_s + k * kStep_s) - 1.7e3 * v - 1.1e4 * x) -
                           friction_N * std::tanh(v / kReversal);
      v += kStep_s * force / (23.0 * kTimes);
      x += kStep_s * v;
    }
  }
  recording.samples.channels = {std::move(voltage), std::move(position)};
  return recording;
}

/// Bounds of laws grow with the plant's sizes: of the actuator that they are written for none has 200 kN of friction.
TEST(TextPlants, ADriveAThousandTimesLargerHasLawsAsLarge) {
  const std::string folder = ::testing::TempDir(), file = folder + "large_positioner.yaml";
  std::ofstream(file) << large_positioner();
  const auto plant = load_plant(file);
  ASSERT_TRUE(plant) << combine(plant.error()).describe();
  constexpr double kFriction_N = 200.0 * kTimes;
  const std::vector<Recording> fit = {large_stroke("slow", 6.0, kFriction_N, 1),
                                      large_stroke("fast", 2.5, kFriction_N, 2)};
  const auto found = mismatch::explain(nominal_asset("large_positioner"), fit,
                                       std::vector{large_stroke("between", 4.0, kFriction_N, 3)});
  ASSERT_TRUE(found) << found.error().describe();
  ASSERT_EQ(found->verdict, MismatchVerdict::mismatch) << found->summary;
  EXPECT_TRUE(names(*found, "coulomb_friction")) << found->summary;
  const auto& terms = found->explained.physics;
  ASSERT_EQ(terms.size(), 1U);
  const auto strength = terms[0].parameters.find("F_c");
  ASSERT_NE(strength, terms[0].parameters.end()) << found->summary;
  EXPECT_NEAR(strength->second.value, kFriction_N, 0.03 * kFriction_N);
  // The explained asset reads back, beyond the bounds that the laws are written with.
  AssetConfig explained = found->explained;
  explained.asset_id = "L";
  ASSERT_TRUE(save_asset(explained, folder + "large_explained.yaml"));
  const auto back = load_asset(folder + "large_explained.yaml");
  ASSERT_TRUE(back) << back.error().describe();
  EXPECT_EQ(back->physics[0].parameters.at("F_c").value, strength->second.value);
}

/// A positioner that answers a command 30 ms before the log says that it was given; semi-implicit Euler steps.
Recording logged_late(const std::string& name, double period_s, double ripple_s, double volts, unsigned seed) {
  constexpr double kStep_s = 1e-5, kSample_s = 0.01, kDuration_s = 12.0, kLate_s = 0.03;
  constexpr double kMass_kg = 22.0, kDrag_N_s_m = 2000.0, kSpring_N_m = 1e4, kForce_N_V = 100.0;
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 1e-5);
  const auto command = [&](double t) {
    return volts * (1.0 - std::cos(2.0 * std::numbers::pi * t / period_s)) +
           0.6 * std::sin(2.0 * std::numbers::pi * t / ripple_s);
  };
  Recording recording;
  recording.recording_id = name;
  Series u{"drive_voltage", "V", 0.0, {}}, x{"position", "m", 1e-5, {}};
  double way = 0.0, speed = 0.0;
  for (long step = 0, next = 0; static_cast<double>(step) * kStep_s < kDuration_s; ++step) {
    const double t = static_cast<double>(step) * kStep_s;
    if (t >= static_cast<double>(next) * kSample_s) {
      recording.samples.time_s.push_back(t);
      u.values.push_back(t < kLate_s ? 0.0 : command(t - kLate_s));
      x.values.push_back(way + noise(random));
      ++next;
    }
    speed += kStep_s * (kForce_N_V * command(t) - kDrag_N_s_m * speed - kSpring_N_m * way) / kMass_kg;
    way += kStep_s * speed;
  }
  recording.samples.channels = {std::move(u), std::move(x)};
  return recording;
}

/// Viscous friction imitates a delay until the mass is at its bound; there a delay promises nothing more.
TEST(TextPlants, ADelayThatParametersHaveBentToIsFoundFromTheGivenOnes) {
  const std::vector<Recording> fit = {logged_late("slow", 6.0, 1.7, 4.0, 1), logged_late("fast", 2.5, 0.9, 3.0, 2),
                                      logged_late("short", 3.2, 0.7, 3.0, 3)};
  const auto found =
      mismatch::explain(asset_of_file("spring_return"), fit, std::vector{logged_late("between", 4.0, 1.3, 3.5, 4)});
  ASSERT_TRUE(found) << found.error().describe();
  ASSERT_EQ(found->verdict, MismatchVerdict::mismatch) << found->summary;
  ASSERT_EQ(found->effects.size(), 1U) << found->summary;
  EXPECT_EQ(found->effects[0].what.id, "input_delay");
  EXPECT_NEAR(found->effects[0].parameters.at(0).value, -0.030, 0.001);
}

/// A law of one's own that has no value in one direction is left out by its name; what else may be missing is asked.
TEST(TextPlants, ALawWithoutAValueIsLeftOutByItsName) {
  std::string text = large_positioner();
  text.replace(text.find("large_positioner"), std::string("large_positioner").size(), "rooted_positioner");
  text += R"yaml(
laws:
  - id: root_friction
    element: piston
    equation: F_0 * sqrt(speed / v_0)
    meaning: a root that has no value backwards
    parameters:
      F_0: {unit: N, usual: 50.0e3, matters: 1.0e3, min: 0, max: 1.0e6, strength: true, meaning: size}
      v_0: {unit: m/s, usual: 1.0e-3, grid: [1.0e-3], min: 1.0e-5, max: 0.1, meaning: speed}
)yaml";
  const std::string file = ::testing::TempDir() + "rooted_positioner.yaml";
  std::ofstream(file) << text;
  const auto plant = load_plant(file);
  ASSERT_TRUE(plant) << combine(plant.error()).describe();
  constexpr double kFriction_N = 200.0 * kTimes;
  const auto found = mismatch::explain(
      nominal_asset("rooted_positioner"),
      std::vector{large_stroke("slow", 6.0, kFriction_N, 1), large_stroke("fast", 2.5, kFriction_N, 2)},
      std::vector{large_stroke("between", 4.0, kFriction_N, 3)});
  ASSERT_TRUE(found) << found.error().describe();
  EXPECT_TRUE(names(*found, "coulomb_friction")) << found->summary;
  EXPECT_TRUE(std::ranges::any_of(found->notes, [](const std::string& note) {
    return note.find("root friction") != std::string::npos && note.find("finite") != std::string::npos;
  }));
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
