// A plant file around an FMU against the same plant as text: values, sensitivities, laws at an input and at a
// derivative; and every fault by name.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "sealwatch/core/file.hpp"
#include "sealwatch/core/text.hpp"
#include "sealwatch/model/driving_channels.hpp"
#include "sealwatch/model/law_sizes.hpp"
#include "sealwatch/model/simulation.hpp"
#include "services/common/fmi/export/fmu_writer.hpp"
#include "services/common/fmi/export/law_code.hpp"
#include "services/common/fmi/fmu_file.hpp"
#include "services/common/fmi/hosted_runs.hpp"
#include "services/common/fmi/import_fmu.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "tests/unit/fmi/fmu_builder.hpp"
#include "tests/unit/model/recording_for_tests.hpp"

namespace sealwatch::fmi {
namespace {

using testing::HasSubstr;

constexpr SimulationOptions kTight = {.relative_tolerance = 1e-7, .maximum_steps = 2000000};

/// A valve positioner with a return spring: what its equations stand in, as text or from an FMU.
std::string plant_with(const std::string& name, const std::string& fmu, const std::string& output,
                       const std::string& der_x, const std::string& der_v) {
  return "name: " + name + "\nmeaning: valve positioner with a return spring\n" + fmu + R"yaml(
inputs:
  drive_voltage: {unit: V, meaning: command u to the drive}
outputs:
  position: {value: )yaml" +
         output + R"yaml(, unit: m, noise_std: 1.0e-5, meaning: stem position}
parameters:
  M:   {value: 20.0,  unit: kg,    meaning: moved mass, estimate: true}
  F_v: {value: 2.0e3, unit: N s/m, meaning: viscous friction, estimate: true}
  k_s: {value: 1.0e4, unit: N/m,   meaning: stiffness of the return spring, estimate: true}
  k_F: {value: 100.0, unit: N/V,   meaning: force of the drive per voltage}
states:
  v: {)yaml" +
         der_v + R"yaml(unit: m/s, start: "0[m/s]", own: false, size: 1.0}
  x: {)yaml" +
         der_x + R"yaml(unit: m, start: position, size: 0.02}
elements:
  driver:
    meaning: force of the drive from its command
    sites:
      - {kind: voltage_command, symbol: u_lost, signals: {command: drive_voltage}}
  piston:
    meaning: force on the stem
    sites:
      - {kind: piston_force, adds_to: {v: -1/M}, signals: {speed: v, position: x}}
law_sizes: {N: 0.02, m: 1.0, m2: 1.0, m/s: 10.0, N/m: 0.02, N/m2: 0.02, N s/m: 0.01, N s2/m2: 1.0e-3, V: 1.0, A: 1.0, s: 1.0}
)yaml";
}

/// Laws that the plant brings itself, with every operation that an expression has.
constexpr const char* kOwnLaws = R"yaml(
laws:
  - id: gripping_seal
    element: piston
    equation: F_0*sign(speed, v_s) + k*grip
    meaning: an O-ring that grips before it slides
    parameters:
      F_0: {unit: N, usual: 5.0, matters: 0.5, min: 0, max: 100, strength: true}
      k: {unit: N/m, usual: 1.0e3, matters: 100, min: 0, max: 1.0e6, strength: true}
      v_s: {unit: m/s, usual: 1.0e-3, grid: [1.0e-4], min: 1.0e-5, max: 0.1}
    hidden: {name: grip, unit: m, der: "speed - abs(speed)*grip/1e-4[m]", size: 1.0e-4}
  - id: odd_spring
    element: piston
    equation: "k_3*max(position, 0, 1e-3[m])^3*(1 + step(position, 1e-3[m]))*cos(position/1[m])*atan(exp(log(2)))"
    meaning: a spring that grows harder with its way
    parameters:
      k_3: {unit: N/m3, usual: 1.0e7, matters: 10, min: -1.0e9, max: 1.0e9, strength: true}
)yaml";

std::string text_plant(const std::string& name = "spring_in_text") {
  return plant_with(name, "", "x", "der: v, ", "der: (k_F * (drive_voltage - u_lost) - F_v * v - k_s * x) / M, ");
}

std::string plant_text(const std::string& name) {
  return plant_with(name, R"yaml(fmu:
  file: model.fmu
  inputs: {u: drive_voltage - u_lost}
  parameters: {M: M, F_v: F_v, k_s: k_s, k_F: k_F}
  variables: {stem: {variable: position, unit: m}}
)yaml",
                    "stem", "", "");
}

std::string written(const TestFolder& folder, const std::string& text) {
  const std::string file = (folder / "plant.yaml").string();
  std::ofstream(file) << text;
  return file;
}

/// One file for all tests: a plant's name is known from one file alone.
const std::string& text_file() {
  static const TestFolder folder;
  static const std::string file = written(folder, text_plant());
  return file;
}

TimeSeries strokes() {
  TimeSeries samples;
  samples.channels = {{"drive_voltage", "V", 0.0, {}}, {"position", "m", 0.0, {}}};
  for (int row = 0; row < 151; ++row) {
    samples.time_s.push_back(4e-3 * row);
    samples.channels[0].values.push_back(3.0 * std::sin(2.0 * std::numbers::pi * row / 150.0));
    samples.channels[1].values.push_back(0.01);
  }
  return samples;
}

PhysicsTerm law_at(const std::string& element, const std::string& id, const std::string& plant) {
  const auto law = std::ranges::find_if(all_laws(), [&](const Law& known) { return known.id == id && known.evaluate; });
  PhysicsTerm term{.id = id, .element = element, .parameters = {}};
  for (const LawParameter& parameter : law->parameters) {
    const double value = law_start(**find_plant(plant), parameter);
    term.parameters[std::string(parameter.name)] = {value, value, value, false};
  }
  return term;
}

void expect_equal(const std::string& fmu, const std::vector<PhysicsTerm>& physics) {
  const auto text = load_plant(text_file());
  ASSERT_TRUE(text) << text.error().front().describe();
  const auto simulation = [&](const std::string& model) {
    AssetConfig asset = nominal_asset(model);
    asset.physics = physics;
    auto made = PlantSimulation::create(asset, strokes());
    EXPECT_TRUE(made) << made.error().describe();
    return std::move(*made);
  };
  const auto expected_of = simulation((*text)->name), found_of = simulation(fmu);
  const auto run = [&](const PlantSimulation& of) {
    std::vector<FreeQuantity> free;
    for (const auto& parameter : of.plant().parameters) free.push_back(*of.find(parameter.name));
    for (const auto& parameter : of.physics_parameters()) free.push_back(*of.find(parameter.name));
    for (const char* state : {"initial:x", "initial:v"}) free.push_back(*of.find(state));
    auto outputs = of.run(of.start(), free, kTight);
    EXPECT_TRUE(outputs) << outputs.error().describe();
    return std::move(*outputs);
  };
  const SimulatedOutputs expected = run(*expected_of), found = run(*found_of);
  // Of the largest of a column: derivatives by differences lead the integrator to other steps.
  constexpr double kValues = 1e-5, kDifferences = 1e-3;
  EXPECT_LT((expected.values - found.values).cwiseAbs().maxCoeff(), kValues * expected.values.cwiseAbs().maxCoeff());
  ASSERT_EQ(expected.sensitivities.cols(), found.sensitivities.cols());
  for (Eigen::Index k = 0; k < expected.sensitivities.cols(); ++k)
    EXPECT_LE((expected.sensitivities.col(k) - found.sensitivities.col(k)).cwiseAbs().maxCoeff(),
              kDifferences * expected.sensitivities.col(k).cwiseAbs().maxCoeff())
        << fmu << ", column " << k;
}

TEST(FmuPlant, IsThePlantAsTextWithItsSensitivities) {
  for (const char* binary : {"fmu_spring_return2", "fmu_spring_directional2", "fmu_spring_return3"}) {
    const TestFolder folder;
    TestUnit unit = spring_return(binary);
    unit.directional = unit.binary == "fmu_spring_directional2";
    const std::string fmu = folder.build(unit);
    const auto plant = load_plant(written(folder, plant_text(binary)));
    ASSERT_TRUE(plant) << plant.error().front().describe();
    expect_equal(binary, {});
    expect_equal(binary, {law_at("piston", "stribeck_friction", binary)});
    expect_equal(binary, {law_at("piston", "presliding_friction", binary)});
    expect_equal(binary, {law_at("driver", "driver_dead_time", binary)});
  }
}

std::string fault(const TestFolder& folder, const std::string& text) {
  const auto plant = read_plant_file(written(folder, text));
  if (plant) return "read";
  std::string all;
  for (const Error& error : plant.error()) all += error.describe() + "\n";
  return all;
}

std::string with(std::string text, const std::string& from, const std::string& to) {
  EXPECT_NE(text.find(from), std::string::npos) << from;
  return text.replace(text.find(from), from.size(), to);
}

TEST(FmuPlant, FaultsNamePlaceValueAndRule) {
  const TestFolder folder;
  const std::string fmu = folder.build(spring_return("fmu_spring_return2"));
  const std::string good = plant_text("any");
  EXPECT_EQ(fault(folder, good), "read");
  EXPECT_THAT(fault(folder, with(good, "file: model.fmu", "file: modl.fmu")),
              HasSubstr("cannot be opened: No such file"));
  EXPECT_THAT(fault(folder, with(good, "variable: position", "variable: positin")),
              HasSubstr("did you mean 'position'"));
  EXPECT_THAT(fault(folder, with(good, "{u: drive_voltage", "{M: drive_voltage")), HasSubstr("not as input"));
  EXPECT_THAT(fault(folder, with(good, "drive_voltage - u_lost", "drive_voltag - u_lost")), HasSubstr("drive_voltag"));
  EXPECT_THAT(fault(folder, with(good, "  x: {unit: m,", "  y: {unit: m,")),
              HasSubstr("is a state of the FMU and is missing"));
  EXPECT_THAT(fault(folder, with(good, "position, unit: m}", "position, unit: N}")), HasSubstr("another quantity"));
}

/// The spring with parameters that are set once: a number of turns, a way of working, its name.
TestUnit with_settings() {
  TestUnit unit = spring_return("fmu_spring_return2");
  unit.interfaces =
      "<ModelExchange modelIdentifier=\"model\"/><TypeDefinitions><SimpleType name=\"modes\"><Enumeration>"
      "<Item name=\"free\" value=\"1\"/><Item name=\"very stiff\" value=\"2\"/></Enumeration></SimpleType>"
      "</TypeDefinitions>\n";
  const auto add = [&](const std::string& name, const std::string& type) {
    unit.variables += "<ScalarVariable name=\"" + name +
                      "\" valueReference=\"40\" causality=\"parameter\" variability=\"fixed\"><" + type +
                      "/></ScalarVariable>\n";
  };
  add("n", "Integer start=\"3\" min=\"1\" max=\"50\"");
  add("body.mode", "Enumeration declaredType=\"modes\" start=\"1\"");
  add("on", "Boolean start=\"true\"");
  add("gap", "Real start=\"1\" min=\"0\"");
  return unit;
}

TEST(FmuPlant, ASettingThatItsVariableCannotHaveIsRefusedAtItsLine) {
  const TestFolder folder;
  static_cast<void>(folder.build(with_settings()));
  const auto fault_of = [&](const std::string& setting) {
    return fault(folder, with(plant_text("any"), "  inputs: {u:", "  settings:\n    " + setting + "\n  inputs: {u:"));
  };
  EXPECT_THAT(fault_of("n: 7.5"), testing::AllOf(HasSubstr("line 6, key fmu.settings.n: '7.5': must be a whole number"),
                                                 testing::Not(HasSubstr("setting n"))));
  EXPECT_THAT(fault_of("n: 0"), HasSubstr("must be 1 or more"));
  EXPECT_THAT(fault_of("n: 51"), HasSubstr("must be 50 or less"));
  EXPECT_THAT(fault_of("gap: -0.5"), HasSubstr("must be 0 or more"));
  EXPECT_THAT(fault_of("on: 2"), HasSubstr("must be true or false"));
  EXPECT_THAT(fault_of("n: many"), HasSubstr("must have as many numbers as n has elements, 1"));
  EXPECT_THAT(fault_of("nn: 7"), HasSubstr("line 6, key fmu.settings.nn: 'nn': is not a variable of the FMU"));
  for (const char* value : {"9", "1.5", "stiff"})
    EXPECT_THAT(fault_of("body.mode: " + std::string(value)),
                testing::AllOf(HasSubstr("line 6, key fmu.settings.body.mode: '" + std::string(value) + "'"),
                               testing::AnyOf(HasSubstr("is not an item of the enumeration body.mode"),
                                              HasSubstr("must be a whole number")),
                               HasSubstr("its items are free (1), very stiff (2)")));
}

TEST(FmuPlant, AnItemOfAnEnumerationIsSetByItsName) {
  const TestFolder folder;
  const std::string fmu = folder.build(with_settings());
  const auto file = FmuFile::open(fmu, {{"body.mode", "very stiff"}, {"n", "2e1"}, {"on", "false"}});
  ASSERT_TRUE(file) << file.error().describe();
  EXPECT_EQ((*file)->settings().at("body.mode"), "very stiff");
  EXPECT_EQ((*file)->set_values().at("body.mode"), "2");
  EXPECT_EQ((*file)->set_values().at("n"), "20");
  EXPECT_EQ((*file)->set_values().at("on"), "false");
  const auto wrong = FmuFile::open(fmu, {{"body.mode", "9"}});
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().place, "setting body.mode");
}

/// They are set once, before the unit has values: what it would give there is no number of its own.
TEST(FmuPlant, AParameterThatTheUnitsOwnOutputSetsIsRefused) {
  const TestFolder folder;
  static_cast<void>(folder.build(gain()));
  const auto plant = load_plant(written(folder, R"yaml(name: sets_itself
meaning: a gain
fmu:
  file: model.fmu
  inputs: {u: u}
  parameters: {k: 2 * x}
  variables: {x: {variable: x, unit: "1"}}
inputs:
  u: {unit: "1", meaning: u}
outputs:
  x: {value: x, unit: "1", meaning: x}
)yaml"));
  ASSERT_FALSE(plant);
  EXPECT_THAT(plant.error().front().describe(),
              testing::AllOf(HasSubstr("fmu.parameters.k"), HasSubstr("2 * x"), HasSubstr("before the FMU has values"),
                             HasSubstr("a column with it, as an input")));
}

TEST(FmuPlant, OneThatLiesAboutItsDerivativesIsRefused) {
  const TestFolder folder;
  TestUnit unit = spring_return("fmu_spring_lying2");
  unit.directional = true;
  const std::string fmu = folder.build(unit);
  EXPECT_THAT(fault(folder, plant_text("lying")),
              AllOf(HasSubstr("d der(v) / d v is said to be 0"), HasSubstr("not the derivatives of its own values")));
}

TEST(FmuPlant, OneThatLiesByItsInputsOrOfItsOutputsIsRefused) {
  const std::pair<const char*, const char*> lies[] = {
      {"fmu_spring_lies_by_input2", "d der(v) / d u is said to be 10.0"},
      {"fmu_spring_lies_of_output2", "d position / d x is said to be 2.0"},
      {"fmu_spring_lies_of_both2", "d position / d u is said to be 0.5"}};
  for (const auto& [binary, said] : lies) {
    const TestFolder folder;
    TestUnit unit = spring_return(binary);
    unit.directional = true;
    const std::string fmu = folder.build(unit);
    EXPECT_THAT(fault(folder, plant_text(binary)),
                AllOf(HasSubstr(said), HasSubstr("not the derivatives of its own values")));
  }
}

// Sound at its start at 0.01 m, and all the way to 0.012. By inputs they are asked for only where a law is at one. The
// spring's force changes by a hundredth of what the friction's does, over what is usual of each.
TEST(FmuPlant, OneThatLiesWhereARunGoesIsRefusedThere) {
  for (const char* binary :
       {"fmu_spring_lies_beyond2", "fmu_spring_lies_beyond_by_place2", "fmu_spring_lies_beyond_by_input2"}) {
    const TestFolder folder;
    TestUnit unit = spring_return(binary);
    unit.directional = true;
    const std::string fmu = folder.build(unit);
    const std::string text = with(plant_text(binary), "start: position, size: 0.02", "start: position, size: 0.002");
    const auto plant = load_plant(written(folder, text));
    ASSERT_TRUE(plant) << plant.error().front().describe();
    AssetConfig asset = nominal_asset(binary);
    asset.physics = {law_at("driver", "driver_dead_time", binary)};
    for (auto& one : asset.physics.front().parameters) one.second.value *= 0.01;
    const auto simulation = PlantSimulation::create(asset, strokes()).value();
    const std::vector<FreeQuantity> free = {*simulation->find(simulation->physics_parameters().front().name)};
    const auto outputs = simulation->run(simulation->start(), free, kTight);
    ASSERT_FALSE(outputs) << binary;
    EXPECT_THAT(outputs.error().describe(),
                AllOf(HasSubstr("model.fmu"), HasSubstr("those of der(v) at 0."),
                      HasSubstr("gives directional derivatives that are not the derivatives of its own values")));
  }
}

// As of a built-in plant's part: a gross difference may be the work of that drive, and no law is claimed then.
TEST(FmuPlant, WhatDrivesItUnseenIsKnownOfATextAndOfAUnit) {
  const TestFolder folder;
  const std::string fmu = folder.build(spring_return("fmu_spring_return2"));
  constexpr const char* kUnseen = "not_recorded: {drive: the pull of the crane, record: its force}\n";
  for (const auto& [name, text] : {std::pair<std::string, std::string>{"pulled_text", text_plant("pulled_text")},
                                   {"pulled_unit", plant_text("pulled_unit")}}) {
    const auto plant = load_plant(written(folder, text + kUnseen));
    ASSERT_TRUE(plant) << plant.error().front().describe();
    const PlantPart part = simulated_part(nominal_asset(name), strokes());
    EXPECT_EQ(part.not_recorded, "the pull of the crane") << name;
    EXPECT_EQ(part.record, "its force") << name;
    EXPECT_TRUE(part.inputs.empty());
  }
  EXPECT_THAT(fault(folder, text_plant("pulled") + "not_recorded: {drive: the pull of the crane}\n"),
              HasSubstr("key not_recorded.record: must be given"));
}

/// Differences across a corner where the input starts are the mean of both sides.
TEST(FmuPlant, OneWithACornerWhereItsInputStartsIsRead) {
  const TestFolder folder;
  TestUnit unit = spring_return("fmu_spring_one_sided2");
  unit.directional = true;
  const std::string fmu = folder.build(unit);
  EXPECT_EQ(fault(folder, plant_text("one_sided")), "read");
}

/// The asset's plant with its laws, exported and imported again, simulates as the asset does. `hidden`: states of laws, as
/// an imported plant names them.
void expect_same_exported(const TestFolder& folder, const std::string& plant_file, const AssetConfig& asset,
                          const std::string& name, const std::string& hidden, Version version = Version::fmi2) {
  const auto read = read_plant_file(plant_file);
  ASSERT_TRUE(read) << read.error().front().describe();
  const auto model = export_model(read->built.plant, asset, version);
  ASSERT_TRUE(model) << model.error().describe();
  const auto fmu = write_fmu((folder / "out.fmu").string(), *model);
  ASSERT_TRUE(fmu) << fmu.error().describe();
  EXPECT_FALSE(write_fmu((folder / "out.fmu").string(), *model)) << "an FMU was written over";
  if (!fmu->binary) GTEST_SKIP() << fmu->without_binary;
  const bool by_rate = model->description.find("drive_voltage_rate") != std::string::npos;
  EXPECT_EQ(by_rate, asset.physics.back().parameters.contains("tau_d")) << "the law of the delay alone sees the rate";
  const std::string file = (folder / "exported.yaml").string();
  std::ofstream(file) << "name: " << name << R"yaml(
meaning: the plant with its laws
fmu:
  file: out.fmu
  inputs: {drive_voltage: drive_voltage)yaml"
                      << (by_rate ? ", drive_voltage_rate: rate(drive_voltage)}" : "}") << R"yaml(
inputs: {drive_voltage: {unit: V}}
outputs: {position: {value: x, unit: m, noise_std: 1.0e-5}}
states:
  x: {unit: m, start: position, size: 0.02}
  v: {unit: m/s, start: "0[m/s]", own: false, size: 1.0}
)yaml" << hidden << "law_sizes: {}\n";
  auto plant = load_plant(file);
  ASSERT_TRUE(plant) << plant.error().front().describe();
  const auto run = [](const AssetConfig& of) {
    const auto simulation = PlantSimulation::create(of, strokes());
    EXPECT_TRUE(simulation) << simulation.error().describe();
    auto outputs = (*simulation)->run((*simulation)->start(), {}, kTight);
    EXPECT_TRUE(outputs) << outputs.error().describe();
    return std::move(outputs->values);
  };
  const RowMatrix expected = run(asset), found = run(nominal_asset(name));
  EXPECT_LT((expected - found).cwiseAbs().maxCoeff(), 1e-5 * expected.cwiseAbs().maxCoeff());
}

// Differences over steps of a usual quantity's size would be those of quite another input.
TEST(FmuPlant, AnInputsNominalValueIsTheSizeOfItsDifferences) {
  const TestFolder folder;
  const std::string fmu = folder.build(small_input());
  const std::string file = (folder / "plant.yaml").string();
  std::ofstream(file) << R"yaml(name: small_input
meaning: a current of some nanoamperes
fmu:
  file: model.fmu
  inputs: {i: k*current}
  variables: {y: {variable: y, unit: "1"}}
inputs: {current: {unit: A}}
outputs: {shown: {value: y, unit: "1", noise_std: 1.0e-3}}
parameters: {k: {value: 1.0, unit: "1", estimate: true}}
states:
  x: {unit: "1", start: "0", own: false, size: 10.0}
law_sizes: {}
)yaml";
  const auto plant = load_plant(file);
  ASSERT_TRUE(plant) << plant.error().front().describe();
  TimeSeries samples;
  samples.channels = {{"current", "A", 0.0, {}}, {"shown", "1", 0.0, {}}};
  for (int row = 0; row <= 100; ++row) {
    samples.time_s.push_back(0.01 * row);
    for (Series& channel : samples.channels) channel.values.push_back(2e-9);
  }
  const auto simulation = PlantSimulation::create(nominal_asset("small_input"), samples);
  ASSERT_TRUE(simulation) << simulation.error().describe();
  const std::vector<FreeQuantity> free = {*(*simulation)->find("k")};
  const auto outputs = (*simulation)->run((*simulation)->start(), free, {.relative_tolerance = 1e-7});
  ASSERT_TRUE(outputs) << outputs.error().describe();
  for (int row = 0; row <= 100; ++row) {
    const double rise = 1.0 - std::exp(-0.01 * row);
    EXPECT_NEAR(outputs->values(row, 0), 8.0 * rise + 2.0, 1e-5);
    EXPECT_NEAR(outputs->sensitivities(row, 0), 24.0 * rise + 2.0, 1e-3);
  }
}

TEST(ExportedFmu, SimulatesAsThePlantWithItsLaws) {
  const TestFolder folder;
  ASSERT_TRUE(load_plant(text_file()));
  AssetConfig asset = nominal_asset("spring_in_text");
  asset.parameters["M"].value = 25.0;
  asset.physics = {law_at("piston", "stribeck_friction", "spring_in_text"),
                   law_at("piston", "presliding_friction", "spring_in_text"),
                   {.id = "driver_dead_time", .element = "driver", .parameters = {{"tau_d", {0.02, 0.0, 1.0, false}}}}};
  expect_same_exported(
      folder, text_file(), asset, "exported",
      "  bristle: {variable: piston.presliding_friction.bristle, unit: \"1\", start: \"0\", own: false, size: 1.0}\n");
}

TEST(ExportedFmu, OfFmi3SimulatesAsThePlantWithItsLaws) {
  const TestFolder folder;
  ASSERT_TRUE(load_plant(text_file()));
  AssetConfig asset = nominal_asset("spring_in_text");
  asset.physics = {law_at("piston", "stribeck_friction", "spring_in_text"),
                   law_at("piston", "presliding_friction", "spring_in_text"),
                   law_at("driver", "driver_dead_time", "spring_in_text")};
  expect_same_exported(
      folder, text_file(), asset, "exported_by_3",
      "  bristle: {variable: piston.presliding_friction.bristle, unit: \"1\", start: \"0\", own: false, size: 1.0}\n",
      Version::fmi3);
  const auto fmu = FmuFile::open((folder / "out.fmu").string());
  ASSERT_TRUE(fmu) << fmu.error().describe();
  EXPECT_EQ((*fmu)->description().version, Version::fmi3);
}

// Between, at and beyond the points of both tables, one of a state and one of an input with a law.
TEST(ExportedFmu, HasThePlantsTables) {
  const TestFolder folder;
  const std::string text = with(with(text_plant("spring_with_tables"), "k_F * (drive_voltage - u_lost)",
                                     "k_F * pull(drive_voltage - u_lost)"),
                                "- k_s * x", "- k_s * stiffening(x)") +
                           R"yaml(tables:
  pull: {x: [-3, -1, 0, 0.5, 2], x_unit: V, y: [-2.5, -1, 0, 0.2, 2.1], y_unit: V}
  stiffening: {x: [-0.001, 0.001, 0.004, 0.006], x_unit: m, y: [-0.002, 0.001, 0.005, 0.02], y_unit: m}
)yaml";
  const std::string file = written(folder, text);
  const auto plant = load_plant(file);
  ASSERT_TRUE(plant) << plant.error().front().describe();
  AssetConfig asset = nominal_asset("spring_with_tables");
  asset.physics = {law_at("piston", "stribeck_friction", "spring_with_tables"),
                   law_at("driver", "driver_dead_time", "spring_with_tables")};
  expect_same_exported(folder, file, asset, "exported_with_tables", "");
}

TEST(ExportedFmu, HasTheLawsThatThePlantBringsItself) {
  const TestFolder folder;
  const std::string file = written(folder, text_plant("spring_with_laws") + kOwnLaws);
  const auto plant = load_plant(file);
  ASSERT_TRUE(plant) << plant.error().front().describe();
  AssetConfig asset = nominal_asset("spring_with_laws");
  asset.physics = {law_at("piston", "gripping_seal", "spring_with_laws"),
                   law_at("piston", "odd_spring", "spring_with_laws")};
  expect_same_exported(
      folder, file, asset, "exported_with_laws",
      "  grip: {variable: piston.gripping_seal.grip, unit: \"m\", start: \"0\", own: false, size: 1.0e-4}\n");
  const LawCode code = law_code(**plant, asset);
  EXPECT_THAT(code.c, HasSubstr("double piston_gripping_seal(double s1, double s2"));
  EXPECT_THAT(code.c, HasSubstr("double piston_gripping_seal_rate("));
  EXPECT_THAT(code.modelica, HasSubstr("function piston_odd_spring"));
  EXPECT_THAT(code.modelica, Not(HasSubstr("not written here")));
}

TEST(ExportedFmu, ALawOfTheUsersOwnSiteIsAFunctionOfItsSignals) {
  const TestFolder folder;
  const std::string file = written(folder, R"yaml(name: tank_with_own_site
meaning: heated tank
inputs:
  heater: {unit: W}
  ambient: {unit: K}
outputs:
  temperature: {value: T, unit: K, noise_std: 0.05}
parameters:
  C: {value: 3.0e5, unit: J/K}
states:
  T: {der: (heater - lost)/C, unit: K, start: temperature, size: 10}
elements:
  wall:
    sites:
      - {kind: own, unit: W, symbol: lost, signals: {excess: {value: T - ambient, unit: K}}}
laws:
  - id: quadratic_loss
    element: wall
    equation: q*excess*abs(excess, 0.01[K])
    meaning: natural convection
    parameters:
      q: {unit: W/K2, usual: 0.1, matters: 0.01, min: 0, max: 5, strength: true}
)yaml");
  const auto plant = load_plant(file);
  ASSERT_TRUE(plant) << plant.error().front().describe();
  AssetConfig asset = nominal_asset("tank_with_own_site");
  asset.physics = {law_at("wall", "quadratic_loss", "tank_with_own_site")};
  const LawCode code = law_code(**plant, asset);
  EXPECT_THAT(code.c, HasSubstr("unit of the result: W"));
  EXPECT_THAT(code.c, HasSubstr("double wall_quadratic_loss(double s1)"));
  EXPECT_THAT(code.c, HasSubstr(" *   s1: excess [K]\n"));
  EXPECT_THAT(code.modelica, HasSubstr("input Real s1 \"excess [K]\";"));
}

/// Differences by parameters take several instances: as many processes, for each run anew.
TEST(FmuPlant, AUnitThatIsInstantiatedOnceGivesWhatTheOtherGives) {
  const TestFolder folder, once_folder;
  static_cast<void>(folder.build(spring_return("fmu_spring_return2")));
  TestUnit unit = spring_return("fmu_spring_once2");
  unit.interfaces = "<ModelExchange modelIdentifier=\"model\" canBeInstantiatedOnlyOncePerProcess=\"true\"/>\n";
  static_cast<void>(once_folder.build(unit));
  const auto plant = load_plant(written(folder, plant_text("instantiated_often"))),
             once = load_plant(written(once_folder, plant_text("instantiated_once")));
  ASSERT_TRUE(plant) << plant.error().front().describe();
  ASSERT_TRUE(once) << once.error().front().describe();
  const auto simulation = PlantSimulation::create(nominal_asset("instantiated_often"), strokes()),
             of_once = PlantSimulation::create(nominal_asset("instantiated_once"), strokes());
  ASSERT_TRUE(simulation && of_once);
  const std::vector<FreeQuantity> free = {*(*simulation)->find("M"), *(*simulation)->find("k_s")};
  const auto expected = (*simulation)->run((*simulation)->start(), free, kTight);
  ASSERT_TRUE(expected) << expected.error().describe();
  for (int run = 0; run < 2; ++run) {
    const auto outputs = (*of_once)->run((*of_once)->start(), free, kTight);
    ASSERT_TRUE(outputs) << outputs.error().describe();
    EXPECT_NEAR(outputs->values(100, 0), expected->values(100, 0), 1e-9);
    for (const Eigen::Index column : {0, 1})
      EXPECT_NEAR(outputs->sensitivities(100, column), expected->sensitivities(100, column),
                  1e-6 * std::abs(expected->sensitivities(100, column)) + 1e-12);
  }
}

TEST(FmuPlant, AnOutputThatIsNoNumberIsNamedWithItsTime) {
  const TestFolder folder;
  static_cast<void>(folder.build(spring_return("fmu_spring_return2")));
  const auto plant = load_plant(written(folder, with(plant_text("without_number"), "position: {value: stem",
                                                     "position: {value: \"stem + 1e-9[m]*log(0.202 - t/1[s])\"")));
  ASSERT_TRUE(plant) << plant.error().front().describe();
  const auto simulation = PlantSimulation::create(nominal_asset("without_number"), strokes());
  ASSERT_TRUE(simulation);
  const auto outputs = (*simulation)->run((*simulation)->start(), {});
  ASSERT_FALSE(outputs);
  EXPECT_EQ(outputs.error().place, "output position at t = 0.204 s");
  EXPECT_EQ(outputs.error().value, "nan");
  EXPECT_THAT(outputs.error().describe(),
              testing::AllOf(HasSubstr("an output that is not a finite number"), HasSubstr("in the tool that made it"),
                             testing::Not(HasSubstr("moves fastest"))));
}

TEST(FmuPlant, ACrashInARunIsAnErrorOfTheRun) {
  const TestFolder folder;
  const std::string fmu = folder.build(spring_return("fmu_crash2"));
  const auto plant = load_plant(written(folder, plant_text("crashing")));
  ASSERT_TRUE(plant) << plant.error().front().describe();
  const auto simulation = PlantSimulation::create(nominal_asset("crashing"), strokes());
  ASSERT_TRUE(simulation);
  const auto outputs = (*simulation)->run((*simulation)->start(), {});
  ASSERT_FALSE(outputs);
  EXPECT_THAT(outputs.error().describe(), HasSubstr("crashed"));
  std::string last;  // as in a search, which tries other values
  for (int run = 1; run < LostProcesses::kMostCrashes; ++run)
    last = (*simulation)->run((*simulation)->start(), {}).error().describe();
  EXPECT_THAT(last, testing::Not(HasSubstr("one after the other")));
  EXPECT_THAT((*simulation)->run((*simulation)->start(), {}).error().describe(),
              testing::AllOf(HasSubstr("crashed: Segmentation fault, 6 times one after the other"),
                             HasSubstr("the derivatives at t = 0.5")));
}

/// A run of it as a simulation asks for, with limits of the test's own.
struct HostedStroke {
  AssetConfig asset;
  TimeSeries recorded = strokes();
  RecordedInput input{recorded.time_s, {{.values = recorded.channels[0].values}}};
  ModelValues values = {};
  SimulationOptions options = {};
  [[nodiscard]] RuntimeRun run() const {
    return {.simulation = 1,
            .asset = asset,
            .recorded = recorded,
            .channels = 1,
            .input = input,
            .values = values,
            .free = {},
            .options = options};
  }
};

struct HostedUnit {
  std::shared_ptr<const FmuFile> fmu;
  HostedPlant plant;
  HostedStroke stroke;
};

HostedUnit hosted(const TestFolder& folder, const std::string& binary, const std::string& name) {
  const auto fmu = FmuFile::open(folder.build(spring_return(binary)));
  const std::string file = written(folder, plant_text(name));
  const auto plant = load_plant(file);
  EXPECT_TRUE(plant) << plant.error().front().describe();
  HostedUnit unit{.fmu = *fmu,
                  .plant = {.file = file,
                            .hash = content_hash(*read_file(file, kLongestYaml_bytes)),
                            .fmu_folder = (*fmu)->unpacked().folder.path().string()},
                  .stroke = {.asset = nominal_asset(name)}};
  unit.stroke.values = (*PlantSimulation::create(unit.stroke.asset, unit.stroke.recorded))->start();
  return unit;
}

double seconds_since(Deadline::Clock::time_point begin) {
  return std::chrono::duration<double>(Deadline::Clock::now() - begin).count();
}

/// A search would wait for it at each of its points.
TEST(FmuPlant, AUnitThatHangsIsWaitedForOnce) {
  const TestFolder folder;
  const HostedUnit unit = hosted(folder, "fmu_hang2", "hanging");
  HostedRuns runs(unit.fmu->name(), unit.plant, {.call_s = 1.0});
  const auto first = runs.run(unit.stroke.run());
  ASSERT_FALSE(first);
  EXPECT_THAT(first.error().describe(), testing::AllOf(HasSubstr("model.fmu"), HasSubstr("the derivatives at t = 0.5"),
                                                       HasSubstr("did not answer within 1 s")));
  const auto begin = Deadline::Clock::now();
  const auto second = runs.run(unit.stroke.run());
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().describe(), first.error().describe());
  EXPECT_LT(seconds_since(begin), 0.1);
}

TEST(FmuPlant, ARunThatIsInACallEndsSoonAfterItsDeadline) {
  const TestFolder folder;
  HostedUnit unit = hosted(folder, "fmu_hang2", "hanging_late");
  Deadline deadline;
  deadline.set_in(0.5);
  unit.stroke.options.deadline = &deadline;
  HostedRuns runs(unit.fmu->name(), unit.plant);
  const auto begin = Deadline::Clock::now();
  const auto outputs = runs.run(unit.stroke.run());
  ASSERT_FALSE(outputs);
  EXPECT_THAT(outputs.error().describe(),
              testing::AllOf(HasSubstr("the derivatives at t = 0.5"), HasSubstr("the time limit was over")));
  EXPECT_LT(seconds_since(begin), 10.0);
  unit.stroke.options.deadline = nullptr;  // what a report needs comes behind the deadline
  const auto again = Deadline::Clock::now();
  EXPECT_FALSE(runs.run(unit.stroke.run()));
  EXPECT_LT(seconds_since(again), 0.1);
}

/// Its calls are requests of this process: those of other units are made within the process that has the binary.
TEST(FmuPlant, ACallOfAUnitThatIsAloneInItsProcessEndsSoonAfterTheDeadline) {
  const TestFolder folder;
  TestUnit unit = spring_return("fmu_hang2");
  unit.interfaces = "<ModelExchange modelIdentifier=\"model\" canBeInstantiatedOnlyOncePerProcess=\"true\"/>\n";
  static_cast<void>(folder.build(unit));
  const auto plant = load_plant(written(folder, plant_text("hanging_alone")));
  ASSERT_TRUE(plant) << plant.error().front().describe();
  const auto simulation = PlantSimulation::create(nominal_asset("hanging_alone"), strokes());
  ASSERT_TRUE(simulation) << simulation.error().describe();
  Deadline deadline;
  deadline.set_in(0.5);
  const auto begin = Deadline::Clock::now();
  const auto outputs = (*simulation)->run((*simulation)->start(), {}, {.deadline = &deadline});
  ASSERT_FALSE(outputs);
  EXPECT_THAT(outputs.error().describe(), HasSubstr("its time was up"));
  EXPECT_LT(seconds_since(begin), 10.0);
  const auto again = Deadline::Clock::now();
  EXPECT_THAT((*simulation)->run((*simulation)->start(), {}).error().describe(),
              testing::AllOf(HasSubstr("the derivatives at t = 0.5"), HasSubstr("the time limit was over")));
  EXPECT_LT(seconds_since(again), 0.5);
}

/// A service runs for months: what the unit waited for may be there again. A run between makes single crashes of them.
TEST(FmuPlant, AUnitThatWasGivenUpIsTriedAgainLater) {
  const TestFolder folder;
  const HostedUnit unit = hosted(folder, "fmu_crash2", "crashing_again");
  const auto now = LostProcesses::Clock::now();
  const auto run_until = [&](LostProcesses& lost, double end_s) {
    auto process = RunProcess::start(unit.fmu->name(), unit.plant, 1U << 20U, {});
    ASSERT_TRUE(process) << process.error().describe();
    HostedStroke stroke = unit.stroke;
    while (stroke.recorded.time_s.back() > end_s) {
      stroke.recorded.time_s.pop_back();
      for (Series& channel : stroke.recorded.channels) channel.values.pop_back();
    }
    stroke.input = {stroke.recorded.time_s, {{.values = stroke.recorded.channels[0].values}}};
    EXPECT_EQ((*process)->run(stroke.run()).has_value(), end_s < 0.5);
    lost.note(**process, now);
  };
  LostProcesses lost;
  for (int run = 1; run < LostProcesses::kMostCrashes; ++run) run_until(lost, 0.6);
  run_until(lost, 0.3);
  for (int run = 1; run < LostProcesses::kMostCrashes; ++run) run_until(lost, 0.6);
  EXPECT_FALSE(lost.given_up(now));
  run_until(lost, 0.6);
  EXPECT_TRUE(lost.given_up(now));
  EXPECT_FALSE(lost.given_up(now + std::chrono::minutes(11)));
}

}  // namespace
}  // namespace sealwatch::fmi
