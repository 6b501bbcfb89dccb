// What `plant import` writes is a plant file as it is; a Co-Simulation unit is simulated and differentiated too.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "sealwatch/core/file.hpp"
#include "sealwatch/model/simulation.hpp"
#include "services/common/fmi/import_fmu.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "tests/unit/fmi/fmu_builder.hpp"
#include "tests/unit/model/recording_for_tests.hpp"

namespace sealwatch::fmi {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string imported(const TestFolder& folder, const TestUnit& unit, const std::string& name) {
  const auto fmu = FmuFile::open(folder.build(unit));
  EXPECT_TRUE(fmu) << fmu.error().describe();
  auto text = plant_file_of(**fmu, "model.fmu");
  EXPECT_TRUE(text) << text.error().describe();
  text->replace(text->find("name: test"), 10, "name: " + name);
  const std::string file = (folder / "plant.yaml").string();
  std::ofstream(file) << *text;
  return file;
}

TEST(ImportedFmu, IsAPlantFileAsItIs) {
  const TestFolder folder;
  int number = 0;
  for (const TestUnit& unit : {spring_return("fmu_spring_return2"), spring_return("fmu_spring_return3"), emps(),
                               bouncing("fmu_bouncing2"), bouncing("fmu_bouncing3"), gain()}) {
    const auto plant = read_plant_file(imported(folder, unit, "imported_" + std::to_string(++number)));
    EXPECT_TRUE(plant) << unit.binary << ": " << plant.error().front().describe();
  }
}

/// Simulated with the input at `value` throughout, and nothing else recorded than zeros.
Result<SimulatedOutputs> simulated(const std::string& plant, double value, const std::string& channel,
                                   double first_time_s = 0.0, const std::string& free = "") {
  const auto loaded = load_plant(plant);
  if (!loaded) return fail(loaded.error().front().describe());
  TimeSeries samples;
  samples.channels = {{"u", "1", 0.0, {}}, {channel, "1", 0.0, {}}};
  for (int row = 0; row <= 100; ++row) {
    samples.time_s.push_back(first_time_s + 0.02 * row);
    samples.channels[0].values.push_back(value);
    samples.channels[1].values.push_back(0.0);
  }
  const auto simulation = PlantSimulation::create(nominal_asset((*loaded)->name), samples);
  if (!simulation) return fail(simulation.error());
  std::vector<FreeQuantity> quantities;
  if (!free.empty()) quantities.push_back(*(*simulation)->find(free));
  return (*simulation)->run((*simulation)->start(), quantities);
}

/// The spring as tools for Modelica name and describe it: quotes, brackets, blanks, aliases, an enumeration, starts that
/// are left out, five hundred variables.
TestUnit as_a_vendor_exports_it() {
  TestUnit unit = spring_return("fmu_spring_talks2");
  const auto put = [&](const std::string& name, int reference, const std::string& attributes, const std::string& type) {
    unit.variables += "<ScalarVariable name=\"" + name + "\" valueReference=\"" + std::to_string(reference) + "\" " +
                      attributes + ">" + type + "</ScalarVariable>\n";
  };
  unit.variables.clear();
  put("$STATESET1.x[1]", 1000, "initial=\"exact\"", "<Real unit=\"m\" start=\"0\" nominal=\"1e-3\"/>");
  put("'my body'.v", 1001, "initial=\"exact\"", "<Real unit=\"m/s\" start=\"0\"/>");
  put("der($STATESET1.x[1])", 2000, "", "<Real derivative=\"1\"/>");
  put("der('my body'.v)", 2001, "", "<Real derivative=\"2\"/>");
  put("u", 3000, "causality=\"input\"", "<Real/>");
  put("body.m", 4000, "causality=\"parameter\" variability=\"tunable\"", "<Real unit=\"kg\"/>");
  put("damper[1].d", 4001, "causality=\"parameter\" variability=\"tunable\"", "<Real start=\"2e3\"/>");
  put("spring.c", 4002, "causality=\"parameter\" variability=\"fixed\"", "<Real start=\"1e4\"/>");
  put("k_F", 4003, "causality=\"calculatedParameter\" variability=\"fixed\"", "<Real/>");
  put("y, 1: {#}", 5000, "causality=\"output\"", "<Real unit=\"m\"/>");
  for (int k = 0; k < 500; ++k)
    put("pipe.mediums[" + std::to_string(k / 10 + 1) + "].'h " + std::to_string(k % 10) + "'", 1000, "", "<Real/>");
  return unit;
}

TEST(ImportedFmu, OneAsAVendorsToolExportsItIsSimulated) {
  const TestFolder folder;
  const auto said = simulated(imported(folder, as_a_vendor_exports_it(), "of_a_vendor"), 1.0, "y_1");
  ASSERT_TRUE(said) << said.error().describe();
  const TestFolder plain;
  const auto expected =
      simulated(imported(plain, spring_return("fmu_spring_return2"), "of_no_vendor"), 1.0, "position");
  ASSERT_TRUE(expected) << expected.error().describe();
  // Its nominal value is a size, so that it is integrated more exactly.
  EXPECT_LT((said->values - expected->values).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(ImportedFmu, OneOfThousandsOfOutputsIsAPlantFileToo) {
  const TestFolder folder;
  TestUnit unit = spring_return("fmu_spring_return2");
  for (int k = 0; k < 1500; ++k)
    unit.variables += "<ScalarVariable name=\"system.hydraulicCircuit.pump[3].chamber.medium.y" + std::to_string(k) +
                      "\" valueReference=\"5000\" causality=\"output\"><Real/></ScalarVariable>\n";
  const auto plant = read_plant_file(imported(folder, unit, "many_outputs"));
  EXPECT_TRUE(plant) << plant.error().front().describe();
}

TEST(ImportedFmu, APlantFileThatIsTooLongIsNotToldOfCommas) {
  const TestFolder folder;
  const std::string file = (folder / "long.yaml").string();
  std::ofstream(file) << std::string(kLongestYaml_bytes + 1, '#');
  const auto plant = read_plant_file(file);
  ASSERT_FALSE(plant);
  EXPECT_THAT(plant.error().front().describe(), AllOf(HasSubstr("is longer than"), Not(HasSubstr("commas"))));
}

TEST(ImportedFmu, AVariableMayBeNamedLikeAWordOfYaml) {
  const TestFolder folder;
  for (const std::string name : {"null", "Null", "NULL", "true", "no"}) {
    TestUnit unit = spring_return("fmu_spring_return2");
    for (const std::string original : {"\"position\"", "\"M\"", "\"u\""})
      unit.variables.replace(unit.variables.find("name=" + original), 5 + original.size(),
                             "name=\"" + name + (original == "\"u\"" ? "" : "." + original.substr(1, 1)) + "\"");
    unit.variables.replace(unit.variables.find("name=\"v\""), 8, "name=\"" + name + "\"");
    unit.variables.replace(unit.variables.find("name=\"" + name + "\" valueReference=\"1001\""), 7 + name.size(),
                           "name=\"" + name + ".v\"");
    const auto plant = read_plant_file(imported(folder, unit, "words_" + name));
    EXPECT_TRUE(plant) << name << ": " << plant.error().front().describe();
  }
}

TEST(ImportedFmu, ASensorThatSaturatesDoesSoInTheSimulation) {
  const TestFolder folder;
  const auto outputs =
      simulated(imported(folder, spring_return("fmu_spring_saturates2"), "saturates"), 100.0, "position");
  ASSERT_TRUE(outputs) << outputs.error().describe();
  EXPECT_NEAR(outputs->values(5, 0), outputs->values.topRows(6).maxCoeff(), 1e-12) << "it rises";
  EXPECT_DOUBLE_EQ(outputs->values(100, 0), 0.5) << "x is 1 there";
}

/// An initial equation: it rests where the first sample's input holds it, as it goes on to do.
TEST(ImportedFmu, OneThatStartsAtRestDoesSoAtTheRecordedInput) {
  const TestFolder folder;
  TestUnit stepping = gain();
  stepping.binary = "fmu_gain_steady_cs2";
  const auto check = [](const Result<SimulatedOutputs>& outputs, double rest) {
    ASSERT_TRUE(outputs) << outputs.error().describe();
    constexpr double kIntegrated = 1e-6;
    for (const Eigen::Index row : {0, 1, 50, 100}) EXPECT_NEAR(outputs->values(row, 0), rest, kIntegrated) << row;
  };
  check(simulated(imported(folder, spring_return("fmu_spring_steady2"), "steady"), 50.0, "position", 5.0), 0.5);
  check(simulated(imported(folder, stepping, "steady_steps"), 5.0, "x", 5.0), 10.0);
}

/// x = k_F u / k_s at the start, and u = drive k_s / 1e4 here: k_s moves nothing.
TEST(ImportedFmu, AStartChangesWithParametersThroughTheInputsToo) {
  const TestFolder folder;
  const std::string file = imported(folder, spring_return("fmu_spring_steady2"), "steady_by_parameter");
  std::string text = read_file(file, kLongestYaml_bytes).value();
  text.replace(text.find("\"u\": u\n"), 7, "\"u\": u * k_s / 1e4\n");
  std::ofstream(file) << text;
  const auto outputs = simulated(file, 50.0, "position", 0.0, "k_s");
  ASSERT_TRUE(outputs) << outputs.error().describe();
  constexpr double kDifferences = 1e-4;  // of the one-sided differences, relative to x / k_s
  for (const Eigen::Index row : {0, 100}) EXPECT_NEAR(outputs->sensitivities(row, 0) * 1e4 / 0.5, 0.0, kDifferences);
}

TEST(ImportedFmu, ACoSimulationUnitIsSimulatedAndFitted) {
  const TestFolder folder;
  const auto plant = load_plant(imported(folder, gain(), "co_simulated"));
  ASSERT_TRUE(plant) << plant.error().front().describe();
  TimeSeries samples;
  samples.channels = {{"u", "1", 0.0, {}}, {"x", "1", 0.0, {}}};
  for (int row = 0; row <= 100; ++row) {
    samples.time_s.push_back(5.0 + 0.02 * row);
    samples.channels[0].values.push_back(row < 3 ? row / 3.0 : 1.0);
    samples.channels[1].values.push_back(0.0);
  }
  const auto simulation = PlantSimulation::create(nominal_asset("co_simulated"), samples);
  ASSERT_TRUE(simulation) << simulation.error().describe();
  const std::vector<FreeQuantity> free = {*(*simulation)->find("k")};
  const auto outputs = (*simulation)->run((*simulation)->start(), free);
  ASSERT_TRUE(outputs) << outputs.error().describe();
  // x = k (t - r + ...): the ramp of 0.06 s delays the step by half of it.
  const double expected = 2.0 * (1.0 - std::exp(-(2.0 - 0.03)));
  EXPECT_NEAR(outputs->values(100, 0), expected, 2e-3);
  EXPECT_NEAR(outputs->sensitivities(100, 0), expected / 2.0, 2e-3);
}

}  // namespace
}  // namespace sealwatch::fmi
