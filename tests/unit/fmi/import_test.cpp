// What `sealwatch plant import` writes of an FMU.
#include <gmock/gmock.h>

#include <chrono>

#include "sealwatch/core/file.hpp"
#include "services/common/fmi/import_fmu.hpp"
#include "tests/unit/fmi/fmu_builder.hpp"

namespace sealwatch::fmi {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string imported(const TestFolder& folder, const TestUnit& unit) {
  const auto file = FmuFile::open(folder.build(unit));
  if (!file) return file.error().describe();
  const auto text = plant_file_of(**file, "model.fmu");
  return text ? *text : text.error().describe();
}

TEST(ImportFmu, BothVersionsGiveTheSameRows) {
  const TestFolder folder;
  for (const char* binary : {"fmu_spring_return2", "fmu_spring_return3"}) {
    EXPECT_THAT(
        imported(folder, spring_return(binary)),
        AllOf(HasSubstr("file: \"model.fmu\""), HasSubstr("    \"u\": u\n"), HasSubstr("    \"k_s\": k_s\n"),
              HasSubstr("position: {unit: \"m\", value: position,"), HasSubstr("M: {unit: \"1\", value: 20.0, min: 2"),
              HasSubstr("x: {variable: \"x\", unit: \"m\", start: [position, \"0.0[m]\"], size: 1.0, own: true"),
              HasSubstr("v: {variable: \"v\", unit: \"1\", start: \"0.0[1]\", size: 1.0, own: false"),
              HasSubstr("# Its derivatives are: der(x) der(v)")));
  }
}

TEST(ImportFmu, NamesBecomeNamesOfExpressionsAndUnitsSi) {
  const TestFolder folder;
  TestUnit unit = spring_return("fmu_spring_return2");
  const auto replace = [&](const std::string& from, const std::string& to) {
    unit.variables.replace(unit.variables.find(from), from.size(), to);
  };
  replace("name=\"M\"", "name=\"body.parts[2].M\"");
  replace("start=\"20\"", "start=\"20\" unit=\"mm\"");
  replace("name=\"F_v\"", "name=\"t\"");
  EXPECT_THAT(imported(folder, unit), AllOf(HasSubstr("\"body.parts[2].M\": body_parts_2_M"), HasSubstr("\"t\": t_"),
                                            HasSubstr("body_parts_2_M: {unit: \"m\", value: 0.02")));
}

/// Simulated and recorded in kelvin: 10 degC more are 10 K.
TEST(ImportFmu, ADifferenceIsConvertedWithoutAnOffset) {
  const TestFolder folder;
  TestUnit unit = spring_return("fmu_spring_return2");
  const auto put = [&](const std::string& text) {
    unit.variables.insert(unit.variables.find("start=\"20\""), text + " ");
  };
  put("unit=\"degC\"");
  EXPECT_THAT(imported(folder, unit), HasSubstr("M: {unit: \"K\", value: 293.15,"));
  put("relativeQuantity=\"true\"");
  EXPECT_THAT(imported(folder, unit), HasSubstr("M: {unit: \"K\", value: 20.0,"));
}

TEST(ImportFmu, AnOutputThatIsAStateIsTakenAsTheState) {
  const TestFolder folder;
  TestUnit unit = spring_return("fmu_spring_return2");
  unit.variables.replace(unit.variables.find("5000"), 4, "1000");
  EXPECT_THAT(imported(folder, unit),
              AllOf(HasSubstr("position: {unit: \"m\", value: x,"), HasSubstr("start: [position, \"0.0[m]\"]")));
}

/// As units of most tools are, the exported ones among them: another value reference, with the state's value. Whether
/// they are one everywhere is not known.
TEST(ImportFmu, AnOutputThatEqualsAStateStartsItAndStaysAVariable) {
  const TestFolder folder;
  for (const char* binary : {"fmu_spring_return2", "fmu_spring_return3", "fmu_bouncing2", "fmu_spring_saturates2"}) {
    const bool ball = std::string(binary).starts_with("fmu_bouncing");
    EXPECT_THAT(imported(folder, ball ? bouncing(binary) : spring_return(binary)),
                ball ? AllOf(HasSubstr("height: {unit: \"1\", value: height,"),
                             HasSubstr("start: [height, \"1.0[1]\"], size: 1.0, own: true"))
                     : AllOf(HasSubstr("position: {unit: \"m\", value: position,"), HasSubstr("start: [position,")));
  }
}

TEST(ImportFmu, AnOutputInAnotherUnitThanTheStateIsAVariableOfItsOwn) {
  const TestFolder folder;
  TestUnit unit = spring_return("fmu_spring_return2");
  const std::size_t output = unit.variables.find("name=\"position\"");
  unit.variables.replace(unit.variables.find("unit=\"m\"", output), 8, "unit=\"mm\"");
  EXPECT_THAT(imported(folder, unit), AllOf(HasSubstr("position: {variable: \"position\", unit: \"m\"}"),
                                            HasSubstr("start: \"0.0[m]\", size: 1.0, own: false")));
}

TEST(ImportFmu, AStateThatAnInputMovesStartsWhereTheUnitSays) {
  const TestFolder folder;
  EXPECT_THAT(imported(folder, spring_return("fmu_spring_steady2")),
              AllOf(HasSubstr("x: {variable: \"x\", unit: \"m\", start: fmu, size: 1.0, own: false"),
                    HasSubstr("v: {variable: \"v\", unit: \"1\", start: \"0.0[1]\"")));
}

TEST(ImportFmu, ElementsOfAnArrayOfOneSignKeepItAsScalarsDo) {
  const TestFolder folder;
  EXPECT_THAT(imported(folder, arrays()), AllOf(HasSubstr("x0_1: {unit: \"1\", value: 1.0, min: 0.1, max: 10.0"),
                                                HasSubstr("x0_2: {unit: \"1\", value: 2.0, min: 0.2, max: 20.0")));
}

TEST(ImportFmu, ElementsOfAnArrayOfBothSignsMayBeOfEitherWithinItsSize) {
  const TestFolder folder;
  TestUnit unit = arrays();
  unit.variables.replace(unit.variables.find("start=\"1 2\""), 11, "start=\"1 -2\"");
  EXPECT_THAT(imported(folder, unit), AllOf(HasSubstr("x0_1: {unit: \"1\", value: 1.0, min: -20.0, max: 20.0"),
                                            HasSubstr("x0_2: {unit: \"1\", value: -2.0, min: -20.0, max: 20.0")));
}

TEST(ImportFmu, OfThousandsOfParametersSomeAreListedAndTheRestCounted) {
  const TestFolder folder;
  TestUnit unit = spring_return("fmu_spring_return2");
  for (int k = 0; k < 5000; ++k)
    unit.variables += "<ScalarVariable name=\"p" + std::to_string(k) +
                      "\" valueReference=\"4000\" causality=\"parameter\" variability=\"fixed\"><Real "
                      "start=\"20\"/></ScalarVariable>\n";
  const std::string text = imported(folder, unit);
  EXPECT_LT(text.size(), kLongestYaml_bytes) << "else the plant's file is refused";
  EXPECT_THAT(text, AllOf(HasSubstr("\n  # p400: {unit"), Not(HasSubstr("p4000")),
                          HasSubstr("  # ... and 4404 more: add those of modelDescription.xml")));
}

TEST(ImportFmu, OfThousandsOfInputsAndOutputsSomeAreListedAndTheRestCounted) {
  const TestFolder folder;
  TestUnit unit = spring_return("fmu_spring_return2");
  for (const std::string causality : {"output", "input"})
    for (int k = 0; k < 3000; ++k)
      unit.variables += "<ScalarVariable name=\"system.hydraulicCircuit.pump[3].chamber.medium." + causality +
                        std::to_string(k) + "\" valueReference=\"" + (causality == "input" ? "3000" : "5000") +
                        "\" causality=\"" + causality + "\"><Real start=\"0\"/></ScalarVariable>\n";
  const std::string text = imported(folder, unit);
  EXPECT_LT(text.size(), kLongestYaml_bytes) << "else the plant's file is refused";
  EXPECT_THAT(text, AllOf(HasSubstr("medium_output100: {variable:"), HasSubstr("\n    \"u\": u\n"),
                          HasSubstr("here and in fmu.inputs"), HasSubstr("here and in fmu.variables")));
}

TEST(ImportFmu, WordsThatAreMarkedUpAreWrittenPlain) {
  const TestFolder folder;
  TestUnit unit = spring_return("fmu_spring_return2");
  const auto replace = [&](const std::string& from, const std::string& to) {
    unit.variables.replace(unit.variables.find(from), from.size(), to);
  };
  replace(
      "name=\"M\"",
      "name=\"M\" description=\"&lt;html&gt;&lt;p class='a'&gt;Masse&lt;br/&gt;des&#10;  &lt;b&gt;Schiebers&lt;/b&gt; "
      "m&lt;n &gt; 0&lt;/p&gt;&lt;/html&gt;\"");
  EXPECT_THAT(imported(folder, unit), HasSubstr("meaning: \"Masse des Schiebers m<n > 0\""));
}

TEST(ImportFmu, ItemsOfAnEnumerationAndTheSizeOfAStateAreTheDescriptions) {
  const TestFolder folder;
  TestUnit unit = spring_return("fmu_spring_return2");
  unit.interfaces =
      "<ModelExchange modelIdentifier=\"model\"/><TypeDefinitions><SimpleType name=\"modes\"><Enumeration>"
      "<Item name=\"free\" value=\"1\"/><Item name=\"very stiff\" value=\"2\"/></Enumeration></SimpleType>"
      "</TypeDefinitions>\n";
  unit.variables +=
      "<ScalarVariable name=\"mode\" valueReference=\"40\" causality=\"parameter\" variability=\"fixed\">"
      "<Enumeration declaredType=\"modes\" start=\"2\"/></ScalarVariable>\n";
  unit.variables.insert(unit.variables.find("unit=\"m\""), "nominal=\"0.05\" ");  // where the binary answers 1
  EXPECT_THAT(imported(folder, unit), AllOf(HasSubstr("\"mode\": 2.0  (1.0 free, 2.0 very stiff)"),
                                            HasSubstr("x: {variable: \"x\", unit: \"m\", start: [position, "
                                                      "\"0.0[m]\"], size: 0.05,")));
}

TEST(ImportFmu, ANameOfTwoVariablesIsRefused) {
  const TestFolder folder;
  for (const std::string name : {"M", "position", "x"}) {
    TestUnit unit = spring_return("fmu_spring_return2");
    unit.variables +=
        "<ScalarVariable name=\"" + name + "\" valueReference=\"4001\"><Real start=\"1\"/></ScalarVariable>\n";
    EXPECT_THAT(imported(folder, unit), AllOf(HasSubstr("'" + name + "'"), HasSubstr("is the name of two variables")));
  }
}

TEST(ImportFmu, OneWithBothInterfacesSaysThatItHasASolverOfItsOwn) {
  const TestFolder folder;
  EXPECT_THAT(imported(folder, mixed("fmu_mixed2")), HasSubstr("interface: me  # it has Co-Simulation too"));
  EXPECT_THAT(imported(folder, gain()), HasSubstr("interface: cs\n"));
  EXPECT_THAT(imported(folder, bouncing("fmu_bouncing2")), HasSubstr("interface: me\n"));
}

/// The seconds that it takes; what it tells is put to `told`.
double seconds_of_import(const TestFolder& folder, const TestUnit& unit, const ImportOptions& given,
                         std::string& told) {
  const auto file = FmuFile::open(folder.build(unit));
  EXPECT_TRUE(file);
  ImportOptions options = given;
  options.tell = [&](const std::string& words) { told += words + "\n"; };
  const auto begin = std::chrono::steady_clock::now();
  const auto text = plant_file_of(**file, "model.fmu", options);
  EXPECT_TRUE(text) << text.error().describe();
  EXPECT_THAT(*text, HasSubstr("start: [position, \"0.0[m]\"]")) << "what shows a state needs no other parameters";
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

TEST(ImportFmu, OneThatHangsAtOtherParametersIsNotWaitedForLong) {
  const TestFolder folder;
  std::string told;
  constexpr double kSoon_s = 20.0;  // the first start has 120 s
  EXPECT_LT(seconds_of_import(folder, spring_return("fmu_spring_stubborn2"), {.trial_s = 0.5}, told), kSoon_s);
  EXPECT_THAT(told, AllOf(HasSubstr("did not answer within"), HasSubstr("was not tried: u, M, F_v, k_s, k_F;")));
}

/// Not once more with parameters left out, which it may refuse: that would be told as a second wait with another limit.
TEST(ImportFmu, OneThatHangsAtItsStartIsStartedOnce) {
  const TestFolder folder;
  const auto file = FmuFile::open(folder.build(spring_return("fmu_spring_hang2")));
  ASSERT_TRUE(file) << file.error().describe();
  const auto begin = std::chrono::steady_clock::now();
  const auto text = plant_file_of(**file, "model.fmu", {.start_s = 1.0, .trial_s = 20.0});
  ASSERT_FALSE(text);
  EXPECT_THAT(text.error().describe(), HasSubstr("did not answer within 1 s"));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
}

TEST(ImportFmu, OneThatRefusesOtherParametersSlowlyIsTriedForAWhile) {
  const TestFolder folder;
  std::string told;
  static_cast<void>(seconds_of_import(folder, spring_return("fmu_spring_refuses2"), {.trials_s = 0.3}, told));
  EXPECT_THAT(told, AllOf(HasSubstr("each is changed alone, for at most 0.3 s"), HasSubstr("k_F; write `start: fmu`"),
                          Not(HasSubstr("tried: u"))));
}

/// With its own inputs: with recorded ones it may start somewhere.
TEST(ImportFmu, WhatHasNoNumberIsLeftToTheUnitByName) {
  const TestFolder folder;
  TestUnit unit = spring_return("fmu_spring_unset2");
  unit.variables.replace(unit.variables.find("start=\"2e3\""), 11, "");  // F_v: as the unit has it
  std::string told;
  for (const TestUnit& one : {spring_return("fmu_spring_nowhere2"), unit}) {
    const auto file = FmuFile::open(folder.build(one));
    ASSERT_TRUE(file);
    const auto text =
        plant_file_of(**file, "model.fmu", {.tell = [&](const std::string& words) { told += words + "\n"; }});
    ASSERT_TRUE(text) << text.error().describe();
    EXPECT_THAT(*text, AllOf(HasSubstr("  k_s: {unit"), Not(HasSubstr("nan"))));
    if (one.binary == unit.binary)
      EXPECT_THAT(*text, Not(HasSubstr("F_v")));
    else
      EXPECT_THAT(*text, HasSubstr("x: {variable: \"x\", unit: \"m\", start: fmu"));
  }
  EXPECT_THAT(told, AllOf(HasSubstr("state x starts at no finite number"), HasSubstr("F_v has no finite value")));
}

TEST(ImportFmu, OneThatDoesNotStartIsRefusedByName) {
  const TestFolder folder;
  EXPECT_THAT(imported(folder, spring_return("fmu_spring_licence2")), HasSubstr("licence"));
}

std::string told_of(const TestFolder& folder, const TestUnit& unit, std::string& text, Choice choice = {}) {
  std::string told;
  const auto file = FmuFile::open(folder.build(unit), {}, choice);
  if (!file) return file.error().describe();
  const auto written =
      plant_file_of(**file, "model.fmu", {.tell = [&](const std::string& words) { told += words + "\n"; }});
  text = written ? *written : written.error().describe();
  return told;
}

/// Tools export parameters that their own binaries do not let be set; of many it is not said which.
TEST(ImportFmu, ParametersThatTheBinaryRefusesAreLeftOut) {
  const TestFolder folder;
  for (const char* binary : {"fmu_mixed2", "fmu_mixed3"}) {
    TestUnit unit = mixed(binary);
    const bool fmi3 = std::string(binary).ends_with('3');
    const auto as_parameter = [&](const std::string& name) {
      const std::size_t at = unit.variables.find("name=\"" + name + "\"");
      const std::size_t output = unit.variables.find("causality=\"output\"", at);
      unit.variables.replace(output, 18, "causality=\"parameter\"");
      const std::size_t continuous = unit.variables.find("variability=\"continuous\"", at);
      unit.variables.replace(continuous, 24, "variability=\"fixed\"");
      const std::size_t start =
          fmi3 ? unit.variables.find("variability", continuous) : unit.variables.find("<Real", at) + 5;
      unit.variables.insert(start, " start=\"3\" ");
    };
    as_parameter("now"), as_parameter("began");
    std::string text;
    EXPECT_THAT(told_of(folder, unit, text),
                AllOf(HasSubstr("it does not start with values for 2 parameters"), HasSubstr("now, began; left out")));
    EXPECT_THAT(text, AllOf(HasSubstr("\"x0\": x0"), Not(HasSubstr("\"now\": now"))));
  }
}

TEST(ImportFmu, UnitsThatAreNotDefinedAreNamed) {
  const TestFolder folder;
  TestUnit unit = spring_return("fmu_spring_return2");
  const auto put = [&](const std::string& before, const std::string& text) {
    unit.variables.insert(unit.variables.find(before), text + " ");
  };
  put("start=\"20\"", "unit=\"Stueck\""), put("start=\"2e3\"", "unit=\"N.s/m\"");
  std::string text;
  EXPECT_THAT(told_of(folder, unit, text), AllOf(HasSubstr("Stueck (M): the FMU does not define these units"),
                                                 HasSubstr("1e5[Pa]*p"), Not(HasSubstr("N.s/m"))));
  EXPECT_THAT(text, HasSubstr("meaning: \"M [Stueck]\"}  # unit: the FMU does not define its \"Stueck\"; give what"));
}

/// Tools that have no unit definitions name their units all the same.
TEST(ImportFmu, UnitsThatAreNotDefinedAreTakenByTheirNames) {
  const TestFolder folder;
  TestUnit unit = spring_return("fmu_spring_return2");
  const auto put = [&](const std::string& before, const std::string& text) {
    unit.variables.insert(unit.variables.find(before), text + " ");
  };
  put("start=\"20\"", "unit=\"t\""), put("start=\"2e3\"", "unit=\"N*s/m\""), put("start=\"1e4\"", "unit=\"kN/m\"");
  std::string text;
  EXPECT_EQ(told_of(folder, unit, text), "");
  EXPECT_THAT(text,
              AllOf(HasSubstr("does not define them; each is taken as what its name is: N*s/m (F_v), kN/m (k_s)"),
                    HasSubstr("M: {unit: \"kg\", value: 20000.0"), HasSubstr("F_v: {unit: \"N s/m\", value: 2000.0"),
                    HasSubstr("k_s: {unit: \"N/m\", value: 1e+07"), HasSubstr("meaning: \"k_s\"}\n")));
}

TEST(ImportFmu, ANameOfAUnitIsWhatEngineersMeanByIt) {
  const auto is = [](const char* name, const char* si, double factor, double offset) {
    const auto unit = unit_by_name(name);
    ASSERT_TRUE(unit) << name;
    EXPECT_EQ(unit->name, si) << name;
    EXPECT_NEAR(unit->conversion.factor / factor, 1.0, 1e-6) << name;
    EXPECT_NEAR(unit->conversion.offset, offset, 1e-9) << name;
  };
  is("N", "N", 1.0, 0.0), is("Nm", "N m", 1.0, 0.0), is("degC", "K", 1.0, 273.15), is("rpm", "rad/s", 0.104719755, 0.0);
  is("rad/s", "rad/s", 1.0, 0.0), is("deg", "rad", 0.0174532925, 0.0), is("bar", "Pa", 1e5, 0.0);
  is("MV", "V", 1e6, 0.0), is("m/s^2", "m/s2", 1.0, 0.0), is("l/min", "m3/s", 1e-3 / 60.0, 0.0),
      is("%", "1", 0.01, 0.0);
  for (const char* name : {"", "-", "Stueck", "foo/bar"}) EXPECT_FALSE(unit_by_name(name)) << name;
}

TEST(ImportFmu, AUnitTakenForCoSimulationIsToldOfItsOtherInterface) {
  const TestFolder folder;
  std::string text;
  EXPECT_EQ(told_of(folder, mixed("fmu_mixed2"), text, Choice::co_simulation), "");
  EXPECT_THAT(text, HasSubstr("Imported with --interface me it can be asked for physics too"));
  EXPECT_EQ(told_of(folder, gain(), text), "");
  EXPECT_THAT(text, HasSubstr("Exported for Model Exchange it can be asked for physics too"));
}

}  // namespace
}  // namespace sealwatch::fmi
