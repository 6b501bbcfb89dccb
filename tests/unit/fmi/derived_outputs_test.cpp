// Outputs that a unit computes from a derivative, which what a law adds to that does not reach.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "sealwatch/model/law_sizes.hpp"
#include "sealwatch/model/simulation.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "tests/unit/fmi/fmu_builder.hpp"
#include "tests/unit/model/recording_for_tests.hpp"

namespace sealwatch::fmi {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// The spring that gives its acceleration too.
TestUnit feeling_spring() {
  TestUnit unit = spring_return("fmu_spring_feels2");
  const char* const outputs[] = {"acceleration", "drive", "reaction", "velocity", "net"};
  std::string structure = "<Outputs><Unknown index=\"10\"/>";
  for (int k = 0; k < 5; ++k) {
    unit.variables += "<ScalarVariable name=\"" + std::string(outputs[k]) + "\" valueReference=\"" +
                      std::to_string(5001 + k) + "\" causality=\"output\"><Real/></ScalarVariable>\n";
    structure += "<Unknown index=\"" + std::to_string(11 + k) + "\"/>";
  }
  unit.structure = structure + "</Outputs><Derivatives><Unknown index=\"3\"/><Unknown index=\"4\"/></Derivatives>\n";
  return unit;
}

std::string plant_file(const TestFolder& folder, const std::string& name, const std::string& section,
                       const std::string& outputs, const std::string& states, const std::string& site) {
  const std::string file = (folder / (name + ".yaml")).string();
  std::ofstream(file) << "name: " << name << "\nmeaning: a valve with a return spring\n"
                      << section << R"yaml(inputs: {drive_voltage: {unit: V}}
outputs:
)yaml" << outputs << R"yaml(parameters:
  M:   {value: 20.0,  unit: kg}
  F_v: {value: 2.0e3, unit: N s/m}
  k_s: {value: 1.0e4, unit: N/m}
  k_F: {value: 100.0, unit: N/V}
states:
)yaml" << states << R"yaml(elements:
  piston:
    meaning: force on the stem
    sites:
      - )yaml" << site << R"yaml(
law_sizes: {N: 0.02, m: 1.0, m2: 1.0, m/s: 10.0, N/m: 0.02, N/m2: 0.02, N s/m: 0.01, N s2/m2: 1.0e-3, s: 1.0}
)yaml";
  return file;
}

constexpr const char* kPosition = "  position: {value: position, unit: m, noise_std: 1.0e-5}\n";
constexpr const char* kSite = "{kind: piston_force, adds_to: {v: -1/M}, signals: {speed: v, position: x}}";

std::string unit_file(const TestFolder& folder, const std::string& name, const std::string& outputs,
                      const std::string& site = kSite) {
  static_cast<void>(folder.build(feeling_spring()));
  const std::string section = R"yaml(fmu:
  file: model.fmu
  inputs: {u: drive_voltage}
  parameters: {M: M, F_v: F_v, k_s: k_s, k_F: k_F}
  variables:
    position: {variable: position, unit: m}
    felt: {variable: acceleration, unit: "1"}
    drive: {variable: drive, unit: N}
    reaction: {variable: reaction, unit: N}
    speed: {variable: velocity, unit: m/s}
    net: {variable: net, unit: N}
)yaml";
  return plant_file(folder, name, section, kPosition + outputs,
                    "  x: {unit: m, start: position, size: 0.02}\n"
                    "  v: {unit: m/s, start: \"0[m/s]\", own: false, size: 1.0}\n",
                    site);
}

std::vector<std::string> remarks_on(const std::string& file) {
  const auto plant = read_plant_file(file);
  EXPECT_TRUE(plant) << plant.error().front().describe();
  return plant ? plant->built.remarks : std::vector<std::string>();
}

TEST(DerivedOutputs, AnAccelerometerThatMissesALawIsNamedWithWhatToDo) {
  const TestFolder folder;
  const std::string output = "  accelerometer: {value: \"9.81[m/s2]*felt\", unit: m/s2, noise_std: 1.0e-3}\n";
  EXPECT_THAT(remarks_on(unit_file(folder, "felt", output)),
              ElementsAre(AllOf(HasSubstr("outputs.accelerometer: the FMU computes felt from the derivative of v"),
                                HasSubstr("elements.piston.sites[0].adds_to"), HasSubstr("give the site the symbol"),
                                HasSubstr("(felt + 0.101937[s2/m]*(-1/M)*piston_law)"),
                                HasSubstr("take the output out of the channels"))));
}

// Its mass is a parameter of the plant, which moves the acceleration and not the force.
TEST(DerivedOutputs, ANetForceIsNamedAsWhatMayBeOne) {
  const TestFolder folder;
  EXPECT_THAT(
      remarks_on(unit_file(folder, "net_force", "  load_cell: {value: net, unit: N, noise_std: 0.1}\n")),
      ElementsAre(AllOf(HasSubstr("outputs.load_cell: in the FMU net is in proportion to the derivative of v"),
                        HasSubstr("unless it is the force or flow of one part alone"),
                        HasSubstr("(net + 20[kg]*(-1/M)*piston_law) for net, with what parameters make of 20[kg]"))));
}

// explain and fit, which load the plant, tell it from there.
TEST(DerivedOutputs, ThePlantThatIsLoadedKeepsTheRemark) {
  const TestFolder folder;
  const std::string output = "  accelerometer: {value: \"9.81[m/s2]*felt\", unit: m/s2, noise_std: 1.0e-3}\n";
  const auto plant = load_plant(unit_file(folder, "felt_and_loaded", output));
  ASSERT_TRUE(plant) << plant.error().front().describe();
  EXPECT_THAT((*plant)->remarks, ElementsAre(HasSubstr("computes felt from the derivative of v")));
}

// Forces that make up the balance, and what is integrated of it, are reached by way of the states.
TEST(DerivedOutputs, WhatIsMovedByStatesAloneIsNoneOfThem) {
  const TestFolder folder;
  const std::string others =
      "  load_cell: {value: drive, unit: N, noise_std: 0.1}\n  foot: {value: reaction, unit: N, noise_std: 0.1}\n"
      "  speed_meter: {value: speed, unit: m/s, noise_std: 1.0e-4}\n";
  EXPECT_THAT(remarks_on(unit_file(folder, "others", others)), IsEmpty());
  // No law goes to a derivative here.
  const std::string output = "  accelerometer: {value: \"9.81[m/s2]*felt\", unit: m/s2, noise_std: 1.0e-3}\n";
  EXPECT_THAT(
      remarks_on(unit_file(folder, "by_state", output,
                           "{kind: piston_force, adds_to: {x: \"1[s/kg]\"}, signals: {speed: v, position: x}}")),
      IsEmpty());
}

TEST(DerivedOutputs, TheAdviceGivesWhatThePlantAsTextGives) {
  const TestFolder folder;
  const std::string site =
      "{kind: piston_force, symbol: F_missing, adds_to: {v: -1/M}, signals: {speed: v, position: x}}";
  const std::string advised =
      "  accelerometer: {value: \"9.81[m/s2]*(felt + 0.101937[s2/m]*(-1/M)*F_missing)\", unit: m/s2, noise_std: "
      "1.0e-3}\n";
  const std::string unit = unit_file(folder, "advised_unit", advised, site);
  EXPECT_THAT(remarks_on(unit), IsEmpty());
  const std::string rate = "(k_F*drive_voltage - F_v*v - k_s*x - F_missing)/M";
  const std::string text =
      plant_file(folder, "advised_text", "",
                 "  position: {value: x, unit: m, noise_std: 1.0e-5}\n  accelerometer: {value: " + rate +
                     ", unit: m/s2, noise_std: 1.0e-3}\n",
                 "  x: {der: v, unit: m, start: position, size: 0.02}\n  v: {der: " + rate +
                     ", unit: m/s, start: \"0[m/s]\", own: false, size: 1.0}\n",
                 "{kind: piston_force, symbol: F_missing, signals: {speed: v, position: x}}");
  TimeSeries samples;
  samples.channels = {{"drive_voltage", "V", 0.0, {}}, {"position", "m", 0.0, {}}, {"accelerometer", "m/s2", 0.0, {}}};
  for (int row = 0; row < 151; ++row) {
    samples.time_s.push_back(4e-3 * row);
    samples.channels[0].values.push_back(3.0 * std::sin(2.0 * std::numbers::pi * row / 150.0));
    samples.channels[1].values.push_back(0.01);
    samples.channels[2].values.push_back(0.0);
  }
  std::vector<RowMatrix> values;
  for (const auto& [file, name] : {std::pair(unit, "advised_unit"), std::pair(text, "advised_text")}) {
    const auto plant = load_plant(file);
    ASSERT_TRUE(plant) << plant.error().front().describe();
    AssetConfig asset = nominal_asset(name);
    const auto law = std::ranges::find_if(
        all_laws(), [](const Law& known) { return known.id == "coulomb_friction" && known.evaluate; });
    PhysicsTerm term{.id = "coulomb_friction", .element = "piston", .parameters = {}};
    for (const LawParameter& parameter : law->parameters) {
      const double value = law_start(**plant, parameter);
      term.parameters[std::string(parameter.name)] = {value, value, value, false};
    }
    asset.physics = {term};
    const auto simulation = PlantSimulation::create(asset, samples);
    ASSERT_TRUE(simulation) << simulation.error().describe();
    const auto outputs = (*simulation)->run((*simulation)->start(), {}, {.relative_tolerance = 1e-7});
    ASSERT_TRUE(outputs) << outputs.error().describe();
    values.push_back(outputs->values);
  }
  for (const Eigen::Index channel : {0, 1})
    EXPECT_LT((values[0].col(channel) - values[1].col(channel)).cwiseAbs().maxCoeff(),
              1e-5 * values[1].col(channel).cwiseAbs().maxCoeff());
}

}  // namespace
}  // namespace sealwatch::fmi
