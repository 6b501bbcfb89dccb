// The same recordings with dry friction hidden in them, and the same plant native, as text and as FMU: fit and explain
// give the same of all three.
#include <gmock/gmock.h>

#include <array>
#include <chrono>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <random>

#include "docs/examples/own_plant/spring_return.hpp"
#include "sealwatch/estimation/actuator_fit.hpp"
#include "sealwatch/mismatch/explain.hpp"
#include "services/common/fmi/export/fmu_writer.hpp"
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

// Sizes of forces ten thousand times too large: a friction that is nothing beside them.
mismatch::Explanation beside_large_sizes(const std::string& name, double friction_N) {
  const fmi::TestFolder folder;
  std::ifstream in(SEALWATCH_SOURCE_DIR "/config/plants/spring_return.yaml");
  std::string text{std::istreambuf_iterator<char>(in), {}};
  text.replace(text.find("name: "), 6, "name: " + name + "_");
  text.replace(text.find("{N: 0.02,"), 9, "{N: 200,");
  std::ofstream((folder / "plant.yaml").string()) << text;
  const std::vector<Recording> fit = {stroke(6.0, friction_N, 1), stroke(2.5, friction_N, 2)};
  const std::vector<Recording> holdout = {stroke(4.0, friction_N, 3)};
  const auto found = mismatch::explain(nominal_asset(loaded((folder / "plant.yaml").string())), fit, holdout);
  if (!found) throw std::runtime_error(found.error().describe());
  return *found;
}

TEST(FmuPlants, ALawThatTheRecordingsShowPlainlyIsFoundWhateverItsSize) {
  const mismatch::Explanation found = beside_large_sizes("plain", kFriction_N);
  ASSERT_EQ(found.verdict, MismatchVerdict::mismatch) << found.summary;
  EXPECT_EQ(found.effects.front().what.id, "coulomb_friction") << found.summary;
}

TEST(FmuPlants, ALawThatIsNothingBesideItsSizeIsToldWithThatSize) {
  const mismatch::Explanation found = beside_large_sizes("hidden", 0.08);
  EXPECT_EQ(found.verdict, MismatchVerdict::undetermined) << found.summary;
  EXPECT_THAT(found.summary, testing::AllOf(testing::HasSubstr("at the piston with"),
                                            testing::HasSubstr("by law_sizes in the plant file (N: 200)")));
  EXPECT_THAT(found.next_test, testing::HasSubstr("Check law_sizes"));
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

/// The text of config/plants as an FMU that `plant export` writes, with a plant file around it.
std::string exported_plant(const std::string& name, const std::string& plant_file) {
  static std::vector<std::unique_ptr<fmi::TestFolder>> folders;  // which have to outlive the plants
  const fmi::TestFolder& folder = *folders.emplace_back(std::make_unique<fmi::TestFolder>());
  const std::string text = SEALWATCH_SOURCE_DIR "/config/plants/" + name + ".yaml";
  const auto read = read_plant_file(text);
  if (!read) return ADD_FAILURE() << combine(read.error()).describe(), "";
  const auto model = fmi::export_model(read->built.plant, nominal_asset(loaded(text)));
  if (!model) return ADD_FAILURE() << model.error().describe(), "";
  const auto written = fmi::write_fmu((folder / "model.fmu").string(), *model);
  EXPECT_TRUE(written && written->binary);
  std::ofstream(folder / "plant.yaml") << "name: exported_" << name << plant_file;
  return loaded((folder / "plant.yaml").string());
}

constexpr const char* kDriveAroundUnit = R"yaml(
meaning: electro-mechanical positioning drive
fmu:
  file: model.fmu
  inputs: {motor_voltage: motor_voltage - u_lost}
  parameters: {M: M, F_v: F_v, k_F: k_F}
inputs:
  motor_voltage: {unit: V, course: averaged, range: [-10, 10], role: drive, meaning: voltage command}
outputs:
  position: {value: x, unit: m, noise_std: 2.0e-8, range: [-0.01, 0.30], role: stroke, meaning: carriage position}
parameters:
  M:   {value: 95.11, unit: kg,    meaning: mass of the carriage, estimate: true}
  F_v: {value: 203.5, unit: N s/m, meaning: viscous friction, estimate: true}
  k_F: {value: 35.15, unit: N/V,   meaning: force per voltage}
states:
  x: {unit: m, start: position, size: 0.01}
  v: {unit: m/s, start: rate(position), size: 0.01}
elements:
  driver:
    sites: [{kind: voltage_command, feeds: motor, symbol: u_lost, signals: {command: motor_voltage}}]
  piston:
    sites: [{kind: piston_force, adds_to: {v: -1/M}, signals: {speed: v, position: x}}]
law_sizes: {N: 2.5e-3, m: 2.5, m/s: 10.0, N/m: 1.0e-3, N/m2: 4.0e-4, N s/m: 2.5e-5, N s2/m2: 2.5e-7, V: 1, A: 1, s: 1}
window_s: 2.0
)yaml";

constexpr const char* kTanksAroundUnit = R"yaml(
meaning: two tanks with free outlets
fmu:
  file: model.fmu
  inputs: {pump_voltage: pump_voltage - u_lost}
  parameters: {k4: k4, k1: k1, k3: k3, area_ratio: area_ratio}
inputs:
  pump_voltage: {unit: V, course: held, range: [0, 10], meaning: voltage of the pump}
outputs:
  level_voltage: {value: level_lower, unit: V, noise_std: 0.02, range: [0, 10], meaning: level of the lower tank}
parameters:
  k4: {value: 0.05, unit: 1/s,     meaning: rise of the upper level per pump voltage, estimate: true}
  k1: {value: 0.05, unit: V^0.5/s, meaning: outlet of the upper tank, estimate: true}
  k3: {value: 0.05, unit: V^0.5/s, meaning: outlet of the lower tank, estimate: true}
  area_ratio: {value: 1.0, unit: 1, meaning: bottom area of the upper tank over that of the lower}
states:
  level_upper: {unit: V, start: (k3 / (area_ratio*k1))^2 * level_voltage, size: 10}
  level_lower: {unit: V, start: level_voltage, size: 10}
elements:
  pump:
    sites: [{kind: voltage_command, feeds: pump, symbol: u_lost, signals: {command: pump_voltage}}]
  upper_tank:
    sites: [{kind: tank_flow, adds_to: {level_upper: "-1"}, signals: {level: level_upper}}]
  upper_outlet:
    sites: [{kind: tank_flow, adds_to: {level_upper: "-1", level_lower: area_ratio}, signals: {level: level_upper}}]
  lower_tank:
    sites: [{kind: tank_flow, adds_to: {level_lower: "-1"}, signals: {level: level_lower}}]
law_sizes: {V: 1, V/s: 1, 1/s: 1, V^0.5/s: 1, A: 1, s: 1}
)yaml";

/// What the built-in plant simulates with other parameters and a law that no model has, with noise.
Recording recorded_of(const AssetConfig& truth, const std::string& input, const std::string& output, double noise,
                      double interval_s, const std::vector<double>& drive, double first, unsigned seed) {
  Recording recording;
  recording.recording_id = truth.model + std::to_string(seed);
  for (const ChannelDescription& channel : (*find_plant(truth.model))->channels)
    if (channel.name == input || channel.name == output)
      recording.samples.channels.push_back({channel.name, channel.unit, 0.0, {}});
  for (std::size_t row = 0; row < drive.size(); ++row) {
    recording.samples.time_s.push_back(interval_s * static_cast<double>(row));
    for (Series& series : recording.samples.channels)
      series.values.push_back(series.name == input ? drive[row] : first);
  }
  const auto simulation = PlantSimulation::create(truth, recording.samples);
  EXPECT_TRUE(simulation) << simulation.error().describe();
  const auto outputs = (*simulation)->run((*simulation)->start(), {}, {.relative_tolerance = 1e-7});
  EXPECT_TRUE(outputs) << outputs.error().describe();
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, noise);
  for (Series& series : recording.samples.channels)
    for (std::size_t row = 0; series.name == output && row < drive.size(); ++row)
      series.values[row] = outputs->values(static_cast<Eigen::Index>(row), 0) + normal(random);
  return recording;
}

Recording drive_recording(double period_s, unsigned seed) {
  AssetConfig truth = nominal_asset("emps");
  truth.parameters["M"].value = 104.0, truth.parameters["F_v"].value = 230.0;
  truth.physics = {{.id = "coulomb_friction",
                    .element = "piston",
                    .parameters = {{"F_c", {20.0, 0.0, 1e3, false}}, {"v_s", {1e-3, 1e-5, 1.0, false}}}}};
  std::vector<double> drive;
  for (int row = 0; row < 301; ++row)
    drive.push_back(4.0 * std::sin(2.0 * std::numbers::pi * 0.01 * row / period_s) +
                    std::sin(2.0 * std::numbers::pi * 0.01 * row / (0.31 * period_s)));
  return recorded_of(truth, "motor_voltage", "position", 1e-5, 0.01, drive, 0.1, seed);
}

Recording tanks_recording(unsigned seed) {
  AssetConfig truth = nominal_asset("cascaded_tanks");
  truth.parameters["k4"].value = 0.055, truth.parameters["k1"].value = 0.045, truth.parameters["k3"].value = 0.052;
  truth.physics = {{.id = "linear_outflow", .element = "upper_tank", .parameters = {{"k", {0.006, 0.0, 1.0, false}}}}};
  std::mt19937 random(100 + seed);
  std::uniform_real_distribution<double> level(1.5, 5.0);
  std::vector<double> drive;
  for (int row = 0; row < 300; ++row) drive.push_back(row % 12 == 0 ? level(random) : drive.back());
  return recorded_of(truth, "pump_voltage", "level_voltage", 0.005, 4.0, drive, 4.0, seed);
}

/// Verdict, law with its strength, and figures on a recording that took no part: the same of all three.
void expect_one_explanation(const std::array<std::string, 3>& plants, const std::vector<Recording>& fit,
                            const std::vector<Recording>& holdout, const std::string& law, const std::string& element) {
  std::optional<mismatch::Explanation> first;
  for (const std::string& plant : plants) {
    const auto begin = std::chrono::steady_clock::now();
    auto explained = mismatch::explain(nominal_asset(plant), fit, holdout);
    ASSERT_TRUE(explained) << plant << ": " << explained.error().describe();
    const mismatch::Explanation& found = *explained;
    ASSERT_EQ(found.verdict, MismatchVerdict::mismatch) << plant << ": " << found.summary;
    const mismatch::FoundEffect& effect = found.effects.at(0);
    const mismatch::FoundParameter& size = effect.parameters.at(0);
    const mismatch::ChannelComparison& held_out = found.holdout.channels.at(0);
    std::printf("%s: %s at %s, %.5g +- %.2g, held out %.3f to %.3f of the noise, %.1f s\n", plant.c_str(),
                effect.what.id.c_str(), effect.what.element.c_str(), size.value, size.std_error, held_out.rms_before,
                held_out.rms_after, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    EXPECT_EQ(effect.what.id, law) << plant << ": " << found.summary;
    EXPECT_EQ(effect.what.element, element) << plant;
    EXPECT_LT(held_out.rms_after, 0.1 * held_out.rms_before) << plant;
    if (!first) first = found;
    const mismatch::ChannelComparison& reference = first->holdout.channels.at(0);
    EXPECT_NEAR(size.value, first->effects.at(0).parameters.at(0).value, size.std_error) << plant;
    EXPECT_NEAR(held_out.rms_before, reference.rms_before, 0.02 * reference.rms_before) << plant;
    EXPECT_NEAR(held_out.rms_after, reference.rms_after, 0.02 * reference.rms_after) << plant;
  }
}

TEST(FmuPlants, TheDriveIsExplainedAlikeAsNativePlantAsTextAndAsUnit) {
  expect_one_explanation(
      {"emps", loaded(SEALWATCH_SOURCE_DIR "/config/plants/emps.yaml"), exported_plant("emps", kDriveAroundUnit)},
      {drive_recording(2.0, 1), drive_recording(3.1, 2)}, {drive_recording(2.6, 3)}, "coulomb_friction", "piston");
}

TEST(FmuPlants, TheTanksAreExplainedAlikeAsNativePlantAsTextAndAsUnit) {
  expect_one_explanation({"cascaded_tanks", loaded(SEALWATCH_SOURCE_DIR "/config/plants/cascaded_tanks.yaml"),
                          exported_plant("cascaded_tanks", kTanksAroundUnit)},
                         {tanks_recording(1), tanks_recording(2)}, {tanks_recording(3)}, "linear_outflow",
                         "upper_tank");
}

std::string dosed_bath() {
  static const fmi::TestFolder folder;
  static_cast<void>(folder.build(fmi::dosing()));
  const std::string file = (folder / "plant.yaml").string();
  std::ofstream(file) << R"yaml(name: dosed_bath
meaning: a bath that is dosed with cold water when it is hot
fmu:
  file: model.fmu
  inputs: {u: heater - lost}
  parameters: {tau: tau, drop: drop, gain: gain}
inputs: {heater: {unit: V, course: held}}
outputs: {temperature: {value: T, unit: K, noise_std: 0.05}}
parameters:
  tau: {value: 200, unit: s, estimate: true}
  drop: {value: 8, unit: K, estimate: true}
  gain: {value: 0.05, unit: K/(s V), estimate: true}
states:
  T: {unit: K, start: temperature, size: 10}
elements:
  driver:
    sites: [{kind: voltage_command, symbol: lost, signals: {command: heater}}]
law_sizes: {V: 1, s: 1, A: 1, ohm: 1}
)yaml";
  return loaded(file);
}

constexpr double kBath_s = 180.0, kDrop_K = 8.3, kHeat_K_s_V = 0.05;

/// Piece by piece in closed form, each dose at its exact time.
Recording dosed(unsigned seed, int rows = 600, double heat = kHeat_K_s_V) {
  Recording recording;
  recording.recording_id = "dosed_" + std::to_string(seed);
  recording.samples.channels = {{"heater", "V", 0.0, {}}, {"temperature", "K", 0.0, {}}};
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 0.05);
  constexpr std::array kVolts = {8.0, 12.0, 16.0, 6.0, 10.0};
  double u = 0.0, temperature = 320.0;
  for (int row = 0; row < rows; ++row) {
    if (row % 37 == 0) u = kVolts[random() % kVolts.size()];
    recording.samples.time_s.push_back(row);
    recording.samples.channels[0].values.push_back(u);
    recording.samples.channels[1].values.push_back(temperature + noise(random));
    const double end = 293.15 + kBath_s * heat * u;
    for (double left = 1.0; left > 0.0;) {
      const double until_hot = end > 330.0 ? kBath_s * std::log((end - temperature) / (end - 330.0)) : 2.0;
      const double step = std::min(left, until_hot);
      temperature = end + (temperature - end) * std::exp(-step / kBath_s);
      if (step == until_hot) temperature = 330.0 - kDrop_K;
      left -= step;
    }
  }
  return recording;
}

// The noise is the sensor's, whatever jumps; a sample on the wrong side of one misses by a hundred times the noise and
// tells nothing; and a search that ends in the nearest minimum is no fit.
TEST(FmuPlants, OneThatJumpsIsFittedAlikeByFitAndExplain) {
  const std::vector<Recording> fit = {dosed(1), dosed(2)}, holdout = {dosed(3)};
  const AssetConfig asset = nominal_asset(dosed_bath());
  ActuatorFitOptions search;
  search.hopeless_rms = std::numeric_limits<double>::infinity();  // as the command's, of a plant without a seal
  const JointFit fitted = fit_actuator(asset, std::vector{fit[0].samples, fit[1].samples}, search);
  EXPECT_TRUE(fitted.report.admissible);
  EXPECT_LT(fitted.report.channels.at(0).noise_normalised_rms, 1.2);
  const auto explained = mismatch::explain(asset, fit, holdout);
  ASSERT_TRUE(explained) << explained.error().describe();
  EXPECT_LT(explained->fit.channels.at(0).rms_before, 1.2) << explained->summary;
  EXPECT_LT(explained->holdout.channels.at(0).rms_before, 1.2) << explained->summary;
  EXPECT_THAT(explained->summary, testing::HasSubstr("jumps at events"));
  for (const auto& [name, truth] : {std::pair{"tau", kBath_s}, {"drop", kDrop_K}, {"gain", kHeat_K_s_V}}) {
    const auto found = std::ranges::find(fitted.report.parameters, name, &EstimatedParameter::name);
    ASSERT_NE(found, fitted.report.parameters.end());
    EXPECT_NEAR(found->value, truth, 4.0 * found->std_error) << name;
    EXPECT_NEAR(explained->explained.parameters.at(name).value, found->value, found->std_error) << name;
  }
}

// A hundred jumps, and a heater a fifth stronger than the plant file has it: whichever way a value is moved, some jump
// comes to another sample.
TEST(FmuPlants, OneThatJumpsOftenIsFittedFromFarOff) {
  const AssetConfig asset = nominal_asset(dosed_bath());
  ActuatorFitOptions search;
  search.hopeless_rms = std::numeric_limits<double>::infinity();  // as the command's, of a plant without a seal
  const std::vector recordings = {dosed(1, 1800, 0.06).samples, dosed(2, 1800, 0.06).samples};
  const JointFit fitted = fit_actuator(asset, recordings, search);
  EXPECT_TRUE(fitted.report.admissible);
  ASSERT_FALSE(fitted.report.channels.empty());
  EXPECT_LT(fitted.report.channels.at(0).noise_normalised_rms, 1.2);
  for (const auto& [name, truth] : {std::pair{"tau", kBath_s}, {"drop", kDrop_K}, {"gain", 0.06}}) {
    const auto found = std::ranges::find(fitted.report.parameters, name, &EstimatedParameter::name);
    ASSERT_NE(found, fitted.report.parameters.end());
    EXPECT_NEAR(found->value, truth, 4.0 * found->std_error) << name;
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
