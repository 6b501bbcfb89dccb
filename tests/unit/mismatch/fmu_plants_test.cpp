// The same recordings with dry friction hidden in them, and the same plant native, as text and as FMU: fit and explain
// give the same of all three.
#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <numbers>
#include <random>

#include "docs/examples/own_plant/spring_return.hpp"
#include "sealwatch/estimation/actuator_fit.hpp"
#include "sealwatch/mismatch/explain.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "tests/unit/fmi/fmu_builder.hpp"
#include "tests/unit/model/recording_for_tests.hpp"

namespace sealwatch {
namespace {

constexpr double kFriction_N = 60.0, kNoise_m = 1e-5;

std::string loaded(const std::string& file) {
  const auto plant = load_plant(file);
  if (!plant) ADD_FAILURE() << combine(plant.error()).describe();
  return plant ? (*plant)->name : "";
}

std::string native_plant() {
  static const bool added = add_plant<example::SpringReturnModel>(example::describe_spring_return()).has_value();
  EXPECT_TRUE(added);
  return "spring_return";
}

std::string text_plant() { return loaded(SEALWATCH_SOURCE_DIR "/config/plants/spring_return.yaml"); }

/// The text's plant, its equations in an FMU.
std::string fmu_plant(const std::string& binary) {
  static std::vector<std::unique_ptr<fmi::TestFolder>> folders;  // which have to outlive the plants
  const fmi::TestFolder& folder = *folders.emplace_back(std::make_unique<fmi::TestFolder>());
  static_cast<void>(folder.build(fmi::spring_return(binary)));
  const std::string file = (folder / "plant.yaml").string();
  std::ofstream(file) << "name: of_" << binary << R"yaml(
meaning: valve positioner with a return spring
fmu:
  file: model.fmu
  inputs: {u: drive_voltage - u_lost}
  parameters: {M: M, F_v: F_v, k_s: k_s, k_F: k_F}
inputs:
  drive_voltage: {unit: V, meaning: command u to the drive}
outputs:
  position: {value: x, unit: m, noise_std: 1.0e-5, meaning: stem position}
parameters:
  M:   {value: 20.0,  unit: kg,    meaning: moved mass, estimate: true}
  F_v: {value: 2.0e3, unit: N s/m, meaning: viscous friction, estimate: true}
  k_s: {value: 1.0e4, unit: N/m,   meaning: stiffness of the return spring, estimate: true}
  k_F: {value: 100.0, unit: N/V,   meaning: force of the drive per voltage}
states:
  x: {unit: m, start: position, size: 0.02}
  v: {unit: m/s, start: "0[m/s]", own: false, size: 0.1}
elements:
  driver:
    meaning: force of the drive from its command
    sites:
      - {kind: voltage_command, symbol: u_lost, signals: {command: drive_voltage}}
  piston:
    meaning: force on the stem
    sites:
      - {kind: piston_force, adds_to: {v: -1/M}, signals: {speed: v, position: x}}
law_sizes: {N: 0.02, m: 1.0, m/s: 10.0, N/m: 0.02, N/m2: 0.02, N s/m: 0.01, N s2/m2: 1.0e-3, V: 1.0, A: 1.0, s: 1.0}
)yaml";
  return loaded(file);
}

/// Strokes of a plant that is not quite the models': other parameters, and friction that no model has.
Recording stroke(double period_s, double friction_N, unsigned seed) {
  constexpr double kSample_s = 0.01;
  constexpr int kRows = 801;
  AssetConfig truth = nominal_asset(text_plant());
  truth.parameters["M"].value = 23.0, truth.parameters["F_v"].value = 1.7e3, truth.parameters["k_s"].value = 1.1e4;
  if (friction_N > 0.0)
    truth.physics = {{.id = "coulomb_friction",
                      .element = "piston",
                      .parameters = {{"F_c", {friction_N, 0.0, 1e3, false}}, {"v_s", {1e-3, 1e-5, 1.0, false}}}}};
  Recording recording;
  recording.recording_id = "stroke_" + std::to_string(seed);
  recording.samples.channels = {{"drive_voltage", "V", 0.0, {}}, {"position", "m", 0.0, {}}};
  for (int row = 0; row < kRows; ++row) {
    const double t = kSample_s * row;
    recording.samples.time_s.push_back(t);
    recording.samples.channels[0].values.push_back(4.0 * (1.0 - std::cos(2.0 * std::numbers::pi * t / period_s)));
    recording.samples.channels[1].values.push_back(0.0);
  }
  const auto simulation = PlantSimulation::create(truth, recording.samples);
  EXPECT_TRUE(simulation) << simulation.error().describe();
  const auto outputs = (*simulation)->run((*simulation)->start(), {}, {.relative_tolerance = 1e-7});
  EXPECT_TRUE(outputs) << outputs.error().describe();
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, kNoise_m);
  for (int row = 0; row < kRows; ++row)
    recording.samples.channels[1].values[static_cast<std::size_t>(row)] = outputs->values(row, 0) + noise(random);
  return recording;
}

template <class Work>
double seconds(const Work& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

TEST(FmuPlants, FitGivesTheParametersOfTheTextPlant) {
  const std::vector<TimeSeries> recordings = {stroke(6.0, 0.0, 1).samples, stroke(2.5, 0.0, 2).samples};
  const JointFit text = fit_actuator(nominal_asset(text_plant()), recordings);
  for (const char* binary : {"fmu_spring_return2", "fmu_spring_return3"}) {
    JointFit fmu;
    std::printf("%s fitted in %.2f s\n", binary,
                seconds([&] { fmu = fit_actuator(nominal_asset(fmu_plant(binary)), recordings); }));
    EXPECT_TRUE(fmu.report.admissible);
    ASSERT_EQ(fmu.report.parameters.size(), text.report.parameters.size());
    for (std::size_t k = 0; k < text.report.parameters.size(); ++k) {
      const EstimatedParameter &one = text.report.parameters[k], &other = fmu.report.parameters[k];
      EXPECT_EQ(one.name, other.name);
      EXPECT_NEAR(one.value, other.value, 0.1 * one.std_error + 1e-9 * std::abs(one.value)) << one.name;
    }
  }
}

// Sizes of forces ten thousand times too large: the friction is found, and nothing beside them.
TEST(FmuPlants, ALawThatIsNothingBesideItsSizeIsToldWithThatSize) {
  const fmi::TestFolder folder;
  std::ifstream in(SEALWATCH_SOURCE_DIR "/config/plants/spring_return.yaml");
  std::string text{std::istreambuf_iterator<char>(in), {}};
  text.replace(text.find("name: "), 6, "name: oversized_");
  text.replace(text.find("{N: 0.02,"), 9, "{N: 200,");
  std::ofstream((folder / "plant.yaml").string()) << text;
  const std::vector<Recording> fit = {stroke(6.0, kFriction_N, 1), stroke(2.5, kFriction_N, 2)};
  const std::vector<Recording> holdout = {stroke(4.0, kFriction_N, 3)};
  const auto found = mismatch::explain(nominal_asset(loaded((folder / "plant.yaml").string())), fit, holdout);
  ASSERT_TRUE(found) << found.error().describe();
  EXPECT_EQ(found->verdict, MismatchVerdict::undetermined) << found->summary;
  EXPECT_THAT(found->summary, testing::AllOf(testing::HasSubstr("friction at the piston with F_c = 60"),
                                             testing::HasSubstr("by law_sizes in the plant file (N: 200)")));
  EXPECT_THAT(found->next_test, testing::HasSubstr("Check law_sizes"));
}

TEST(FmuPlants, ExplainGivesTheLawOfTheTextAndOfTheNativePlant) {
  const std::vector<Recording> fit = {stroke(6.0, kFriction_N, 1), stroke(2.5, kFriction_N, 2)};
  const std::vector<Recording> holdout = {stroke(4.0, kFriction_N, 3)};
  std::optional<mismatch::Explanation> first;
  for (const std::string& plant : {native_plant(), text_plant(), fmu_plant("fmu_spring_directional2")}) {
    std::optional<mismatch::Explanation> found;
    const double took_s = seconds([&] {
      auto explained = mismatch::explain(nominal_asset(plant), fit, holdout);
      ASSERT_TRUE(explained) << plant << ": " << explained.error().describe();
      found = std::move(*explained);
    });
    ASSERT_TRUE(found);
    ASSERT_EQ(found->verdict, MismatchVerdict::mismatch) << plant << ": " << found->summary;
    const mismatch::FoundEffect& effect = found->effects.at(0);
    const mismatch::FoundParameter& strength = effect.parameters.at(0);
    const mismatch::ChannelComparison& held_out = found->holdout.channels.at(0);
    std::printf("%s: %s at %s, %.2f +- %.2f N, held out %.3f to %.3f of the noise, %.1f s\n", plant.c_str(),
                effect.what.id.c_str(), effect.what.element.c_str(), strength.value, strength.std_error,
                held_out.rms_before, held_out.rms_after, took_s);
    EXPECT_EQ(effect.what.element, "piston");
    EXPECT_NEAR(strength.value, kFriction_N, 3.0 * strength.std_error) << plant;
    EXPECT_LT(held_out.rms_after, 1.2) << plant;
    if (!first) first = found;
    const mismatch::FoundEffect& reference = first->effects.at(0);
    EXPECT_EQ(effect.what.id, reference.what.id) << plant;
    EXPECT_NEAR(strength.value, reference.parameters.at(0).value, strength.std_error) << plant;
    EXPECT_NEAR(held_out.rms_before, first->holdout.channels.at(0).rms_before, 0.02 * held_out.rms_before) << plant;
    EXPECT_NEAR(held_out.rms_after, first->holdout.channels.at(0).rms_after, 0.02 * held_out.rms_after) << plant;
  }
}

/// The spring return without elements: no law can be asked within it.
std::string closed_text_plant() {
  static const fmi::TestFolder folder;
  const std::string file = (folder / "plant.yaml").string();
  std::ofstream(file) << R"yaml(name: spring_return_closed
meaning: valve positioner with a return spring
inputs:
  drive_voltage: {unit: V, meaning: command u to the drive}
outputs:
  position: {value: x, unit: m, noise_std: 1.0e-5, meaning: stem position}
parameters:
  M:   {value: 20.0,  unit: kg,    meaning: moved mass, estimate: true}
  F_v: {value: 2.0e3, unit: N s/m, meaning: viscous friction, estimate: true}
  k_s: {value: 1.0e4, unit: N/m,   meaning: stiffness of the return spring, estimate: true}
  k_F: {value: 100.0, unit: N/V,   meaning: force of the drive per voltage}
states:
  x: {der: v, unit: m, start: position, size: 0.02}
  v: {der: (k_F * drive_voltage - F_v * v - k_s * x) / M, unit: m/s, start: "0[m/s]", own: false, size: 0.1}
elements: {}
law_sizes: {N: 0.02, m: 1.0, m/s: 10.0, N s/m: 0.01, N s2/m2: 1.0e-3, V: 1.0, A: 1.0, s: 1.0}
)yaml";
  return loaded(file);
}

/// As written for Co-Simulation: dx/dt = k u - x within the unit.
std::string co_simulated_plant() {
  static const fmi::TestFolder folder;
  static_cast<void>(folder.build(fmi::gain()));
  const std::string file = (folder / "plant.yaml").string();
  std::ofstream(file) << R"yaml(name: closed_gain
meaning: a gain with a lag
fmu:
  file: model.fmu
  interface: cs
  inputs: {u: u}
  parameters: {k: k}
  variables: {level: {variable: x, unit: m}}
inputs: {u: {unit: V, meaning: drive}}
outputs: {x: {unit: m, value: level, noise_std: 1.0e-4, meaning: level}}
parameters:
  k: {unit: m/V, value: 2.0, min: 0.2, max: 20.0, estimate: true, meaning: gain}
elements: {}
law_sizes: {N: 0.02, m: 1.0, m/s: 10.0, N s/m: 0.01, N s2/m2: 1.0e-3, V: 1.0, A: 1.0, s: 1.0}
)yaml";
  return loaded(file);
}

/// Of dx/dt = 2 u - x - x^3, in steps of Euler's method.
Recording saturating(double period_s, unsigned seed) {
  constexpr double kSample_s = 0.02;
  Recording recording;
  recording.recording_id = "saturating_" + std::to_string(seed);
  recording.samples.channels = {{"u", "V", 0.0, {}}, {"x", "m", 0.0, {}}};
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 1e-4);
  double x = 0.0;
  const auto drive = [&](double t) { return std::sin(2.0 * std::numbers::pi * t / period_s); };
  for (int row = 0; row <= 500; ++row) {
    const double t = kSample_s * row;
    recording.samples.time_s.push_back(t);
    recording.samples.channels[0].values.push_back(drive(t));
    recording.samples.channels[1].values.push_back(x + noise(random));
    for (int step = 0; step < 200; ++step)
      x += kSample_s / 200.0 * (2.0 * drive(t + step * kSample_s / 200.0) - x - x * x * x);
  }
  return recording;
}

/// What no law could be asked for is no fault of the sensor, and the report says what would let it ask.
void expect_nothing_asked_within(const mismatch::Explanation& found, const std::string& why,
                                 const std::string& advice) {
  EXPECT_TRUE(found.statistically_significant) << found.summary;
  EXPECT_TRUE(found.effects.empty()) << found.summary;
  EXPECT_TRUE(found.location.empty()) << found.location.front().element;
  EXPECT_THAT(found.summary, testing::HasSubstr(why));
  EXPECT_THAT(found.notes, testing::Contains(testing::HasSubstr(why)));
  EXPECT_THAT(found.next_test, testing::HasSubstr(advice));
  EXPECT_THAT(found.next_test, testing::Not(testing::HasSubstr("outliers")));
}

TEST(FmuPlants, AUnitForCoSimulationIsNotAskedForPhysicsAndTheReportSaysSo) {
  const std::vector<Recording> fit = {saturating(5.0, 1), saturating(3.0, 2)}, holdout = {saturating(4.0, 3)};
  const auto found = mismatch::explain(nominal_asset(co_simulated_plant()), fit, holdout);
  ASSERT_TRUE(found) << found.error().describe();
  expect_nothing_asked_within(*found, "for Co-Simulation, which hides its states", "for Model Exchange");
}

TEST(FmuPlants, ATextPlantWithoutElementsIsNotAskedForPhysicsAndTheReportSaysSo) {
  const std::vector<Recording> fit = {stroke(6.0, kFriction_N, 1), stroke(2.5, kFriction_N, 2)};
  const std::vector<Recording> holdout = {stroke(4.0, kFriction_N, 3)};
  const auto found = mismatch::explain(nominal_asset(closed_text_plant()), fit, holdout);
  ASSERT_TRUE(found) << found.error().describe();
  expect_nothing_asked_within(*found, "names no place where physics may be missing", "Add elements with sites");
}

}  // namespace
}  // namespace sealwatch
