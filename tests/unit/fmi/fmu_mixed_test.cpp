// What a unit has besides continuous numbers: discrete and typed inputs, states that its parameters start, settings, an
// end of its own; by Model Exchange and by Co-Simulation.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "sealwatch/model/simulation.hpp"
#include "services/common/fmi/import_fmu.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "tests/unit/fmi/fmu_builder.hpp"
#include "tests/unit/model/recording_for_tests.hpp"

namespace sealwatch::fmi {
namespace {

using testing::HasSubstr;

constexpr std::array kBinaries = {"fmu_mixed2", "fmu_mixed3"};

/// A unit that was imported, as a plant of a name of its own.
class ImportedUnit {
 public:
  ImportedUnit(const TestUnit& unit, const Settings& settings = {}, Choice choice = Choice::model_exchange_first) {
    static int count = 0;
    name_ = "of_unit_" + std::to_string(++count);
    const auto fmu = FmuFile::open(folder_.build(unit), settings, choice);
    if (!fmu) {
      text_ = fmu.error().describe();
      return;
    }
    const auto text = plant_file_of(**fmu, "model.fmu");
    text_ = text ? *text : text.error().describe();
    if (text) replace("name: test", "name: " + name_);
  }
  void replace(const std::string& from, const std::string& to) {
    const std::size_t at = text_.find(from);
    ASSERT_NE(at, std::string::npos) << from << " in\n" << text_;
    text_.replace(at, from.size(), to);
  }
  [[nodiscard]] const std::string& text() const { return text_; }
  /// "" where it is a plant, else what is wrong.
  [[nodiscard]] std::string load() const {
    const std::string file = (folder_ / "plant.yaml").string();
    std::ofstream(file) << text_;
    const auto plant = load_plant(file);
    return plant ? "" : plant.error().front().describe();
  }
  [[nodiscard]] std::unique_ptr<PlantSimulation> simulation(const TimeSeries& recorded) const {
    EXPECT_EQ(load(), "");
    auto made = PlantSimulation::create(nominal_asset(name_), recorded);
    EXPECT_TRUE(made) << made.error().describe();
    return made ? std::move(*made) : nullptr;
  }

 private:
  TestFolder folder_;
  std::string name_, text_;
};

const std::vector<std::string> kInputs = {"u_real", "u_discrete", "u_integer", "u_boolean"};

/// Samples every `step_s`, every input 0 but those that `of` gives.
TimeSeries samples(int count, double step_s, const std::vector<std::string>& outputs, double (*of)(int) = nullptr) {
  TimeSeries series;
  for (const std::string& name : kInputs) series.channels.push_back({name, "1", 0.0, {}});
  for (const std::string& name : outputs) series.channels.push_back({name, "1", 0.0, {}});
  for (int row = 0; row < count; ++row) {
    series.time_s.push_back(step_s * row);
    for (std::size_t k = 0; k < series.channels.size(); ++k) {
      const double value = of == nullptr || k >= kInputs.size() ? 0.0 : of(row);
      series.channels[k].values.push_back(k == 3 && value != 0.0 ? 1.0 : value);
    }
  }
  return series;
}

TEST(FmuInputs, ASampleOfCoSimulationShowsItsOwnInput) {
  for (const char* binary : kBinaries) {
    const ImportedUnit unit(mixed(binary), {}, Choice::co_simulation);
    const TimeSeries recorded =
        samples(6, 0.1, {"y_real", "y_discrete", "y_integer", "y_boolean"}, [](int row) { return 5.0 - row; });
    const auto simulation = unit.simulation(recorded);
    ASSERT_NE(simulation, nullptr);
    const auto outputs = simulation->run(simulation->start(), {});
    ASSERT_TRUE(outputs) << outputs.error().describe();
    for (int row = 0; row < 6; ++row)
      for (int channel = 0; channel < 4; ++channel)
        EXPECT_EQ(outputs->values(row, channel), recorded.channels[channel].values[row])
            << binary << ", sample " << row << ", " << simulation->channels()[channel];
  }
}

TEST(FmuInputs, AWholeNumberBeyondItsTypeIsTheTypesLast) {
  for (const char* binary : kBinaries) {
    const ImportedUnit unit(mixed(binary));
    const auto simulation =
        unit.simulation(samples(2, 0.1, {"y_integer"}, [](int row) { return row > 0 ? 1e12 : -1e12; }));
    ASSERT_NE(simulation, nullptr);
    const auto outputs = simulation->run(simulation->start(), {});
    ASSERT_TRUE(outputs) << outputs.error().describe();
    EXPECT_EQ(outputs->values(0, 0), std::numeric_limits<int>::min()) << binary;
    EXPECT_EQ(outputs->values(1, 0), std::numeric_limits<int>::max()) << binary;
  }
}

TEST(FmuInputs, ASampleWhereAnInputJumpsShowsTheNewInput) {
  for (const char* binary : kBinaries) {
    ImportedUnit unit(mixed(binary));
    EXPECT_THAT(unit.text(), HasSubstr("u_integer: {unit: \"1\", course: held"));
    unit.replace("u_real: {unit: \"1\"", "u_real: {unit: \"1\", course: held");
    const TimeSeries recorded =
        samples(6, 0.1, {"y_real", "y_discrete", "y_integer", "y_boolean"}, [](int row) { return 5.0 - row; });
    const auto simulation = unit.simulation(recorded);
    ASSERT_NE(simulation, nullptr);
    const auto outputs = simulation->run(simulation->start(), {});
    ASSERT_TRUE(outputs) << outputs.error().describe();
    for (int row = 0; row < 6; ++row)
      for (int channel = 0; channel < 4; ++channel)
        EXPECT_EQ(outputs->values(row, channel), recorded.channels[channel].values[row])
            << binary << ", sample " << row << ", " << simulation->channels()[channel];
  }
}

TEST(FmuInputs, ADiscreteOneThatIsNotHeldIsRefusedByName) {
  for (const char* binary : kBinaries) {
    ImportedUnit unit(mixed(binary));
    unit.replace("u_integer: {unit: \"1\", course: held", "u_integer: {unit: \"1\"");
    EXPECT_THAT(unit.load(),
                AllOf(HasSubstr("u_integer"), HasSubstr("may change at events alone"), HasSubstr("course: held")));
    ImportedUnit timed(mixed(binary));
    timed.replace("\"u_integer\": u_integer", "\"u_integer\": u_integer + t / 1[s]");
    EXPECT_THAT(timed.load(), HasSubstr("may change at events alone"));
  }
}

TEST(FmuNames, AStateAndTheChannelThatShowsItHaveOneName) {
  for (const char* binary : kBinaries) {
    const ImportedUnit unit(mixed(binary));
    EXPECT_THAT(unit.text(), HasSubstr("\n  x: {unit: \"1\", value: x,"));
    EXPECT_EQ(unit.load(), "");
  }
}

TEST(FmuStart, AParameterThatStartsAStateKeepsItsEffect) {
  for (const char* binary : kBinaries) {  // FMI 3 by its InitialUnknowns, FMI 2 by a changed value
    const ImportedUnit unit(mixed(binary));
    EXPECT_THAT(unit.text(), HasSubstr("x: {variable: \"x\", unit: \"1\", start: fmu,"));
    const auto simulation = unit.simulation(samples(41, 0.05, {"x"}));
    ASSERT_NE(simulation, nullptr);
    ModelValues values = simulation->start();
    EXPECT_EQ(values.initial_state, std::vector{2.0});
    const FreeQuantity x0 = *simulation->find("x0");
    x0.in(values) = 3.0;
    const std::vector<FreeQuantity> free = {x0, *simulation->find("k")};
    const auto outputs = simulation->run(values, free, {.relative_tolerance = 1e-7});
    ASSERT_TRUE(outputs) << outputs.error().describe();
    for (int row = 0; row < 41; ++row) {
      const double t = 0.05 * row;
      EXPECT_NEAR(outputs->values(row, 0), 3.0 * std::exp(-t), 1e-5) << binary;
      EXPECT_NEAR(outputs->sensitivities(row, 0), std::exp(-t), 1e-4) << binary;
      EXPECT_NEAR(outputs->sensitivities(row, 1), -3.0 * t * std::exp(-t), 1e-4) << binary;
    }
  }
}

TEST(FmuStart, OneThatIsShownStartsWhereTheRecordingDoes) {
  ImportedUnit unit(mixed("fmu_mixed2"));
  unit.replace(", start: fmu,", ", start: [x, \"0.0\"],");
  TimeSeries recorded = samples(3, 0.1, {"x"});
  recorded.channels.back().values = {7.0, 7.0, 7.0};
  const auto simulation = unit.simulation(recorded);
  ASSERT_NE(simulation, nullptr);
  EXPECT_EQ(simulation->start().initial_state, std::vector{7.0});
}

// Wherever a recording begins: what depends on time in the unit is where it was in the log.
TEST(FmuTime, IsTheRecordingsInBothInterfaces) {
  for (const Choice choice : {Choice::model_exchange, Choice::co_simulation})
    for (const char* binary : kBinaries) {
      const ImportedUnit unit(mixed(binary), {}, choice);
      TimeSeries recorded = samples(5, 0.1, {"x", "now", "began"});
      for (double& time_s : recorded.time_s) time_s += 3.25;
      const auto simulation = unit.simulation(recorded);
      ASSERT_NE(simulation, nullptr);
      const auto outputs = simulation->run(simulation->start(), {}, {.relative_tolerance = 1e-8});
      ASSERT_TRUE(outputs) << outputs.error().describe();
      for (int row = 0; row < 5; ++row) {
        EXPECT_NEAR(outputs->values(row, 0), 2.0 * std::exp(-0.1 * row), 1e-6) << binary;
        EXPECT_NEAR(outputs->values(row, 1), 3.25 + 0.1 * row, 1e-9) << binary;
        EXPECT_EQ(outputs->values(row, 2), 3.25) << binary;
      }
    }
}

/// Some cannot do without a stop time. Its maker's experiment ends at 3 s, which is not when a recording does.
TEST(FmuTime, AUnitKnowsWhenItsRunEnds) {
  for (const Choice choice : {Choice::model_exchange, Choice::co_simulation})
    for (const char* binary : {"fmu_mixed_until2", "fmu_mixed_until3"}) {
      TestUnit of = mixed(binary);
      if (choice == Choice::co_simulation) of.experiment = "";
      const ImportedUnit unit(of, {}, choice);
      for (const double step_s : {0.1, 2.0}) {
        const auto simulation = unit.simulation(samples(5, step_s, {"x"}));
        ASSERT_NE(simulation, nullptr) << binary;
        const auto outputs = simulation->run(simulation->start(), {});
        ASSERT_TRUE(outputs) << binary << outputs.error().describe();
        EXPECT_NEAR(outputs->values(4, 0), 2.0 * std::exp(-4.0 * step_s), 1e-4) << binary;
      }
    }
}

TEST(FmuEnd, OneAtTheLastSampleIsNoFault) {
  for (const Choice choice : {Choice::model_exchange, Choice::co_simulation})
    for (const char* binary : kBinaries) {
      const ImportedUnit unit(mixed(binary), {{"last", "3"}}, choice);
      const auto fits = unit.simulation(samples(13, 0.25, {"steps"}));
      ASSERT_NE(fits, nullptr);
      const auto outputs = fits->run(fits->start(), {});
      ASSERT_TRUE(outputs) << outputs.error().describe();
      for (int row = 0; row < 13; ++row) EXPECT_EQ(outputs->values(row, 0), std::floor(0.25 * row)) << binary;
      const auto longer = unit.simulation(samples(20, 0.25, {"steps"}));
      const auto beyond = longer->run(longer->start(), {});
      ASSERT_FALSE(beyond);
      EXPECT_THAT(beyond.error().describe(),
                  AllOf(HasSubstr("ends the simulation by itself at 3.0"), HasSubstr("end the recording there"),
                        Not(HasSubstr("equations")), Not(HasSubstr("parameters' values"))));
    }
}

// In which order the binary has its states, only the structure tells.
/// Derivatives of what is no state: of an input, of an algebraic output beside others that the structure names, of an
/// array without elements.
TEST(FmuStates, AUnitWithoutStatesMayHaveDerivatives) {
  const TestFolder folder;
  TestUnit old = spring_return("fmu_spring_return2");
  old.variables =
      "<ScalarVariable name=\"u\" valueReference=\"3000\" causality=\"input\"><Real start=\"0\"/></ScalarVariable>"
      "<ScalarVariable name=\"y\" valueReference=\"5000\" causality=\"output\"><Real/></ScalarVariable>"
      "<ScalarVariable name=\"dy\" valueReference=\"1001\" causality=\"output\"><Real "
      "derivative=\"2\"/></ScalarVariable>";
  old.structure = "<Outputs><Unknown index=\"2\"/><Unknown index=\"3\"/></Outputs>";
  TestUnit of_input = spring_return("fmu_spring_return3");
  of_input.variables =
      "<Float64 name=\"u\" valueReference=\"3000\" causality=\"input\" start=\"0\"/>"
      "<Float64 name=\"du\" valueReference=\"2000\" causality=\"output\" derivative=\"3000\"/>";
  of_input.structure = "";
  TestUnit empty = of_input;
  empty.variables =
      "<Float64 name=\"x\" valueReference=\"1000\"><Dimension start=\"0\"/></Float64>"
      "<Float64 name=\"dx\" valueReference=\"2000\" derivative=\"1000\"><Dimension start=\"0\"/></Float64>";
  for (const TestUnit& unit : {old, of_input, empty}) {
    const auto file = FmuFile::open(folder.build(unit));
    EXPECT_TRUE(file) << file.error().describe();
  }
  // One that has a start is a state, which the structure should name.
  old.variables.replace(old.variables.find("<Real/>"), 7, "<Real start=\"1\"/>");
  EXPECT_FALSE(FmuFile::open(folder.build(old)));
}

TEST(FmuStates, ThoseThatTheStructureLeavesOutAreMissedByName) {
  for (const char* binary : kBinaries) {
    TestUnit unit = mixed(binary);
    unit.structure.clear();
    EXPECT_THAT(ImportedUnit(unit).text(),
                AllOf(HasSubstr("'der(x)'"), HasSubstr("ModelStructure"), HasSubstr("interface: cs")));
    EXPECT_EQ(ImportedUnit(unit, {}, Choice::co_simulation).load(), "") << binary;
  }
}

TEST(FmuSettings, SetTextsAndSwitchesOnce) {
  for (const char* binary : kBinaries) {
    const ImportedUnit unit(mixed(binary), {{"text", "seven77"}});
    EXPECT_THAT(unit.text(),
                AllOf(HasSubstr("  settings:"), HasSubstr("\"text\": \"seven77\""), HasSubstr("\"last\": 1000")));
    const auto simulation = unit.simulation(samples(3, 0.1, {"length"}));
    ASSERT_NE(simulation, nullptr);
    const auto outputs = simulation->run(simulation->start(), {});
    ASSERT_TRUE(outputs) << outputs.error().describe();
    EXPECT_EQ(outputs->values(2, 0), 7.0);
  }
  EXPECT_THAT(ImportedUnit(mixed("fmu_mixed2"), {{"tex", "a"}}).text(), HasSubstr("did you mean 'text'"));
  EXPECT_THAT(ImportedUnit(mixed("fmu_mixed2"), {{"last", "a"}}).text(), HasSubstr("as many numbers"));
  EXPECT_THAT(ImportedUnit(mixed("fmu_mixed2"), {{"u_integer", "1"}}).text(), HasSubstr("not a parameter"));
}

TEST(FmuSettings, StructuralParametersGiveArraysTheirSize) {
  for (const int size : {2, 4}) {
    const ImportedUnit unit(arrays(), size == 2 ? Settings{} : Settings{{"n", "4"}});
    TimeSeries recorded;
    recorded.channels = {{"y", "1", 0.0, {}}};
    for (int row = 0; row < 21; ++row) recorded.time_s.push_back(0.1 * row), recorded.channels[0].values.push_back(0.0);
    const auto simulation = unit.simulation(recorded);
    ASSERT_NE(simulation, nullptr);
    EXPECT_EQ(simulation->state_names().size(), static_cast<std::size_t>(size));
    const auto outputs = simulation->run(simulation->start(), {}, {.relative_tolerance = 1e-7});
    ASSERT_TRUE(outputs) << outputs.error().describe();
    EXPECT_NEAR(outputs->values(20, 0), 0.5 * size * (size + 1) * std::exp(-2.0), 1e-5);
  }
}

TEST(FmuInterface, CoSimulationCanBeChosenAndKeepsItsStepRules) {
  for (const char* binary : kBinaries) {
    TestUnit rules = mixed(binary);
    const ImportedUnit chosen(rules, {}, Choice::co_simulation);
    EXPECT_THAT(chosen.text(), HasSubstr("interface: cs"));
    const auto simulation = chosen.simulation(samples(21, 0.1, {"x"}));
    ASSERT_NE(simulation, nullptr);
    EXPECT_TRUE(simulation->state_names().empty());
    const auto outputs = simulation->run(simulation->start(), {});
    ASSERT_TRUE(outputs) << outputs.error().describe();
    EXPECT_NEAR(outputs->values(20, 0), 2.0 * std::exp(-2.0), 1e-12);
  }
  EXPECT_THAT(ImportedUnit(gain(), {}, Choice::model_exchange).text(), HasSubstr("no interface for Model Exchange"));
}

TEST(FmuInterface, StepsThatAUnitCannotDoAreNamed) {
  const auto fault = [](const std::string& rule, double second_step_s) -> std::string {
    TestUnit unit = mixed("fmu_mixed3");
    unit.interfaces = "<CoSimulation modelIdentifier=\"model\" " + rule + "/>\n";
    const ImportedUnit imported(unit);
    TimeSeries recorded = samples(3, 0.1, {"x"});
    recorded.time_s[2] = 0.1 + second_step_s;
    const auto simulation = imported.simulation(recorded);
    const auto outputs = simulation->run(simulation->start(), {});
    return outputs ? "" : outputs.error().describe();
  };
  const std::string varies = "canHandleVariableCommunicationStepSize=\"true\" ";
  EXPECT_EQ(fault("", 0.1), "");
  EXPECT_THAT(fault("", 0.15), HasSubstr("does equal steps alone"));
  EXPECT_EQ(fault(varies, 0.15), "");
  EXPECT_EQ(fault(varies + "fixedInternalStepSize=\"0.05\"", 0.15), "");
  EXPECT_THAT(fault(varies + "fixedInternalStepSize=\"0.05\"", 0.12), HasSubstr("not a whole number"));
}

TEST(FmuDerivatives, ThoseThatAUnitDoesNotHaveAreDifferences) {
  TestUnit unit = spring_return("fmu_spring_states2");
  unit.directional = true;
  const ImportedUnit imported(unit);
  EXPECT_EQ(imported.load(), "");
}

// After fmi2Error an instance answers nothing any more.
TEST(FmuDerivatives, AUnitThatFailsForGoodOverThemIsRunWithoutThem) {
  TestUnit unit = spring_return("fmu_spring_broken2");
  unit.directional = true;
  const ImportedUnit imported(unit);
  TimeSeries recorded = samples(5, 0.01, {"position"});
  recorded.channels[0].name = "u";
  const auto simulation = imported.simulation(recorded);
  ASSERT_NE(simulation, nullptr);
  const std::vector<FreeQuantity> free = {*simulation->find("M")};
  const auto outputs = simulation->run(simulation->start(), free);
  EXPECT_TRUE(outputs) << outputs.error().describe();
}

TEST(FmuStart, TheLibrariesBesideABinaryAreFound) {
  TestUnit unit = gain();
  unit.binary = "fmu_gain_needs_cs2";
  EXPECT_THAT(ImportedUnit(unit).text(), HasSubstr("libfmu_gain_library.so: cannot open"));
  unit.library = "libfmu_gain_library.so";
  EXPECT_EQ(ImportedUnit(unit).load(), "");
}

TEST(FmuStart, OneThatNeedsItsToolSaysSo) {
  TestUnit unit = spring_return("fmu_spring_licence2");
  unit.interfaces = "<ModelExchange modelIdentifier=\"model\" needsExecutionTool=\"true\"/>\n";
  EXPECT_THAT(ImportedUnit(unit).text(),
              AllOf(HasSubstr("it needs the tests on this machine"), HasSubstr("needsExecutionTool")));
  unit.binary = "fmu_spring_return2";
  EXPECT_THAT(ImportedUnit(unit).text(),
              HasSubstr("# It runs only where the tests is installed (needsExecutionTool)."));
}

}  // namespace
}  // namespace sealwatch::fmi
