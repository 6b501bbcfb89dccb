// modelDescription.xml of both versions comes to one form, and each fault names its line.
#include <gmock/gmock.h>

#include "sealwatch/core/visible_text.hpp"
#include "services/common/fmi/model_description.hpp"
#include "tests/unit/fmi/fmu_builder.hpp"

namespace sealwatch::fmi {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string refused(const std::string& text) {
  const auto description = read_model_description("m.fmu", text);
  return description ? "accepted" : description.error().describe();
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(ModelDescription, BothVersionsSayTheSame) {
  for (const char* binary : {"fmu_spring_return2", "fmu_spring_return3"}) {
    const auto description = read_model_description("m.fmu", description_of(spring_return(binary)));
    ASSERT_TRUE(description) << description.error().describe();
    ASSERT_EQ(description->states.size(), 2U);
    EXPECT_EQ(description->name_of(description->states[1]), "v");
    EXPECT_EQ(description->name_of(description->derivatives[1]), "der(v)");
    const Variable* mass = description->find("M");
    ASSERT_NE(mass, nullptr);
    EXPECT_EQ(mass->reference, 4000U);
    EXPECT_EQ(mass->causality, FmiCausality::parameter);
    EXPECT_EQ(mass->variability, FmiVariability::fixed);
    EXPECT_EQ(mass->start, std::vector<double>{20.0});
    EXPECT_EQ(description->find("position")->unit, "m");
    EXPECT_EQ(description->find_unit("mm")->factor, 0.001);
    EXPECT_EQ(description->stop_time_s, 3.0);
    EXPECT_FALSE(description->model_exchange->directional_derivatives);
  }
}

TEST(ModelDescription, TypesGiveWhatVariablesLeaveOut) {
  std::string text = description_of(spring_return("fmu_spring_return3"));
  text = replaced(text, "<ModelVariables>",
                  "<TypeDefinitions><Float64Type name=\"Mass\" unit=\"N\" min=\"1\" max=\"50\" nominal=\"20\"/>"
                  "</TypeDefinitions><ModelVariables>");
  text = replaced(text, "name=\"M\"", "name=\"M\" declaredType=\"Mass\" max=\"40\"");
  const auto description = read_model_description("m.fmu", text);
  ASSERT_TRUE(description) << description.error().describe();
  const Variable* mass = description->find("M");
  EXPECT_EQ(mass->unit, "N");
  EXPECT_EQ(mass->min, 1.0);
  EXPECT_EQ(mass->max, 40.0);
  EXPECT_EQ(mass->nominal, 20.0);
}

/// relativeQuantity: 10 degC more are 10 K. A variable may differ from its type.
TEST(ModelDescription, ADifferenceHasNoOffset) {
  for (const char* binary : {"fmu_spring_return2", "fmu_spring_return3"}) {
    const bool fmi2 = std::string(binary).ends_with('2');
    std::string text = description_of(spring_return(binary));
    text = replaced(text, "<ModelVariables>",
                    fmi2 ? "<TypeDefinitions><SimpleType name=\"Rise\"><Real unit=\"degC\" relativeQuantity=\"true\"/>"
                           "</SimpleType></TypeDefinitions><ModelVariables>"
                         : "<TypeDefinitions><Float64Type name=\"Rise\" unit=\"degC\" relativeQuantity=\"true\"/>"
                           "</TypeDefinitions><ModelVariables>");
    text = replaced(text, "start=\"20\"", "start=\"20\" declaredType=\"Rise\"");
    text = replaced(text, "start=\"2e3\"", "start=\"2e3\" declaredType=\"Rise\" relativeQuantity=\"false\"");
    const auto description = read_model_description("m.fmu", text);
    ASSERT_TRUE(description) << description.error().describe();
    EXPECT_EQ(description->si_unit_of(*description->find("M"))->conversion.to_si(10.0), 10.0);
    EXPECT_EQ(description->si_unit_of(*description->find("F_v"))->conversion.to_si(10.0), 283.15);
  }
}

TEST(ModelDescription, TextsOfEightBitsAreUtf8Inside) {
  const std::string text = replaced(description_of(spring_return("fmu_spring_return2")), "<fmiModelDescription",
                                    "<fmiModelDescription description=\"W\xE4rme \x93q\x94\"");
  for (const char* page : {"windows-1252", "ISO-8859-1", "UTF-8"}) {
    const std::string head = std::string("<?xml version=\"1.0\" encoding=\"") + page + "\"?>";
    const auto description = read_model_description("m.fmu", head + text.substr(text.find("<fmiModel")));
    ASSERT_TRUE(description) << page << description.error().describe();
    EXPECT_TRUE(is_valid_utf8(description->description)) << page;
    EXPECT_THAT(description->description, HasSubstr("W\xC3\xA4rme"));
  }
}

TEST(ModelDescription, ArraysHaveTheirElements) {
  TestUnit unit = spring_return("fmu_spring_return3");
  unit.variables = R"xml(<UInt64 name="n" valueReference="1" causality="structuralParameter" start="3"/>
<Float64 name="x" valueReference="1000"><Dimension valueReference="1"/></Float64>
<Float64 name="der(x)" valueReference="2000" derivative="1000"><Dimension valueReference="1"/></Float64>
<Float64 name="A" valueReference="4000" causality="parameter" variability="fixed" start="1 2 3 4 5 6"><Dimension start="2"/><Dimension valueReference="1"/></Float64>
)xml";
  unit.structure = R"(<ContinuousStateDerivative valueReference="2000"/>)";
  const auto description = read_model_description("m.fmu", description_of(unit));
  ASSERT_TRUE(description) << description.error().describe();
  ASSERT_EQ(description->states.size(), 3U);
  EXPECT_EQ(description->name_of(description->states[2]), "x[3]");
  const auto element = description->find_element("A[2,2]");
  ASSERT_TRUE(element) << element.error().describe();
  EXPECT_EQ(description->variables[element->variable].start[element->element], 5.0);
  EXPECT_EQ(description->name_of(*element), "A[2,2]");
  for (const char* name : {"A[2,4]", "A[3,1]", "A[0,1]", "A[5]", "A[1,1,1]", "A[1,]", "A[]", "x[1,1]", "x[4]"})
    EXPECT_THAT(description->find_element(name).error().describe(), HasSubstr("not a variable")) << name;
  EXPECT_THAT(refused(replaced(description_of(unit), "start=\"1 2 3 4 5 6\"", "start=\"1 2 3\"")),
              HasSubstr("each of the 6 elements"));
}

TEST(ModelDescription, AVariableIsFoundByEachOfItsNames) {
  TestUnit unit = spring_return("fmu_spring_return3");
  const std::string position = "name=\"position\" valueReference=\"5000\" causality=\"output\" unit=\"m\"";
  unit.variables = replaced(unit.variables, position + "/>",
                            position + "><Alias name=\"stem.s\" description=\"of the stem\"/></Float64>");
  const auto description = read_model_description("m.fmu", description_of(unit));
  ASSERT_TRUE(description) << description.error().describe();
  const auto element = description->find_element("stem.s");
  ASSERT_TRUE(element) << element.error().describe();
  EXPECT_EQ(description->variables[element->variable].reference, 5000U);
  EXPECT_EQ(std::ranges::count(description->variables, FmiCausality::output, &Variable::causality), 1);
}

TEST(ModelDescription, FaultsNameLineValueAndRule) {
  const std::string good = description_of(spring_return("fmu_spring_return2"));
  EXPECT_THAT(refused("<a><b></a>"), HasSubstr("is not XML"));
  EXPECT_THAT(refused("<a/>"), HasSubstr("no element fmiModelDescription"));
  EXPECT_THAT(refused(replaced(good, "\"2.0\"", "\"1.0\"")), AllOf(HasSubstr("'1.0'"), HasSubstr("line 2")));
  EXPECT_THAT(refused(replaced(good, "guid", "gid")), HasSubstr("lacks the attribute guid"));
  EXPECT_THAT(refused(replaced(good, "valueReference=\"1001\"", "valueReference=\"v\"")),
              AllOf(HasSubstr("line 8"), HasSubstr("v"), HasSubstr("whole number")));
  EXPECT_THAT(refused(replaced(good, "<Real derivative=\"2\"/>", "")), HasSubstr("no type"));
  EXPECT_THAT(refused(replaced(good, "derivative=\"2\"", "derivative=\"99\"")), HasSubstr("99"));
  EXPECT_THAT(refused(replaced(good, "index=\"4\"", "index=\"5\"")), HasSubstr("no attribute derivative"));
  EXPECT_THAT(refused(replaced(good, "start=\"2e3\"", "start=\"two\"")), HasSubstr("start must be a number"));
  EXPECT_THAT(refused(replaced(good, "causality=\"input\"", "causality=\"inputs\"")),
              HasSubstr("is not a causality of the standard"));
  EXPECT_THAT(refused(replaced(good, "modelIdentifier=\"model\"", "modelIdentifier=\"../model\"")),
              HasSubstr("name of the C language"));
  const auto begin = good.find("<ModelExchange"), end = good.find("/>", begin) + 2;
  EXPECT_THAT(refused(good.substr(0, begin) + good.substr(end)), HasSubstr("neither Model Exchange"));
}

TEST(ModelDescription, AStateOfAnotherTypeIsRefusedForItsType) {
  TestUnit unit = spring_return("fmu_spring_return3");
  for (const char* name : {"name=\"x\"", "name=\"der(x)\""}) {
    const std::size_t row = unit.variables.rfind("Float64", unit.variables.find(name));
    unit.variables.replace(row, 7, "Float32");
  }
  EXPECT_THAT(refused(description_of(unit)), AllOf(HasSubstr("'x'"), HasSubstr("is a state that is not a Float64")));
}

TEST(ModelDescription, OnlyClocksThatTickByThemselvesAreTaken) {
  const std::string good = description_of(spring_return("fmu_spring_return3"));
  const auto with_clock = [&](const std::string& attributes) {
    return replaced(good, "</ModelVariables>",
                    "<Clock name=\"tick\" valueReference=\"8000\" " + attributes + "/>\n</ModelVariables>");
  };
  EXPECT_TRUE(read_model_description("m.fmu", with_clock("causality=\"output\" intervalVariability=\"triggered\"")));
  EXPECT_THAT(refused(with_clock("causality=\"input\" intervalVariability=\"constant\" intervalDecimal=\"0.01\"")),
              AllOf(HasSubstr("'tick'"), HasSubstr("is an input clock")));
}

// What the standard starts an input with that says nothing: 0 where that is one of its values.
TEST(ModelDescription, AnEnumerationStartsWithItsFirstValue) {
  for (const char* binary : {"fmu_spring_return2", "fmu_spring_return3"}) {
    const bool fmi2 = binary[17] == '2';
    const std::string values = "<Item name=\"low\" value=\"3\"/><Item name=\"high\" value=\"1\"/>";
    std::string text = description_of(spring_return(binary));
    text = replaced(
        text, "<ModelVariables>",
        (fmi2 ? "<TypeDefinitions><SimpleType name=\"Gear\"><Enumeration>" + values +
                    "</Enumeration></SimpleType></TypeDefinitions>"
              : "<TypeDefinitions><EnumerationType name=\"Gear\">" + values + "</EnumerationType></TypeDefinitions>") +
            "<ModelVariables>");
    const std::string head = "name=\"gear\" valueReference=\"9000\" causality=\"input\" variability=\"discrete\"";
    text = replaced(text, "</ModelVariables>",
                    (fmi2 ? "<ScalarVariable " + head + "><Enumeration declaredType=\"Gear\"/></ScalarVariable>"
                          : "<Enumeration " + head + " declaredType=\"Gear\"/>") +
                        "</ModelVariables>");
    const auto with = [&](const std::string& start) {
      const auto description = read_model_description(
          "m.fmu", start.empty() ? text : replaced(text, " declaredType=\"Gear\"", start + " declaredType=\"Gear\""));
      EXPECT_TRUE(description) << description.error().describe();
      return description->find("gear")->start;
    };
    EXPECT_EQ(with(""), std::vector{3.0}) << binary;
    EXPECT_EQ(with(" start=\"1\""), std::vector{1.0}) << binary;
    text = replaced(text, "value=\"1\"/>", "value=\"0\"/>");
    EXPECT_EQ(with(""), std::vector<double>{}) << binary;
  }
}

TEST(ModelDescription, UnitsGetTheirUsualNames) {
  const auto name = [](BaseExponents exponents) {
    return si_name(Unit{.name = {}, .has_base = true, .exponents = exponents});
  };
  EXPECT_EQ(name({1, 1, -2, 0, 0, 0, 0, 0}), "N");
  EXPECT_EQ(name({1, -1, -2, 0, 0, 0, 0, 0}), "Pa");
  EXPECT_EQ(name({0, 3, -1, 0, 0, 0, 0, 0}), "m3/s");
  EXPECT_EQ(name({0, 0, -1, 0, 0, 0, 0, 1}), "rad/s");
  EXPECT_EQ(name({2, 0, -3, 1, 0, 0, 0, 0}), "kg2 A/s3");
  EXPECT_EQ(name({0, -1, -3, 0, 0, 0, 0, 0}), "1/(m s3)");
  EXPECT_EQ(name({0, -1, 1, 1, 0, 0, 0, 0}), "A s/m");
  EXPECT_EQ(si_name(Unit{}), "1");
}

/// As OpenModelica and others write angles: without their radian.
TEST(ModelDescription, AnAngularUnitHasItsRadianThoughItsBaseUnitHasNone) {
  const auto name = [](const std::string& unit, int seconds, double factor, double offset = 0.0) {
    return si_name(
        Unit{.name = unit, .has_base = true, .exponents = {0, 0, seconds}, .factor = factor, .offset = offset});
  };
  constexpr double kDegree = 0.017453292519943295;
  EXPECT_EQ(name("rad/s", -1, 1.0), "rad/s");
  EXPECT_EQ(name("rpm", -1, 6.0 * kDegree), "rad/s");
  EXPECT_EQ(name("deg", 0, kDegree), "rad");
  EXPECT_EQ(name("rad/s2", -2, 1.0), "rad/s2");
  EXPECT_EQ(name("Hz", -1, 1.0), "1/s");
  EXPECT_EQ(name("1/s", -1, 1.0), "1/s");
  EXPECT_EQ(name("1/min", -1, 1.0 / 60.0), "1/s");
  for (const char* plain : {"", "1", "-", "%"}) EXPECT_EQ(name(plain, 0, plain[0] == '%' ? 0.01 : 1.0), "1") << plain;
}

TEST(ModelDescription, NumbersThatAreNotFiniteSayNothingAndATypeThatIsMissingTellsNothing) {
  for (const char* binary : {"fmu_spring_return2", "fmu_spring_return3"}) {
    TestUnit unit = spring_return(binary);
    const auto at = unit.variables.find("start=\"20\"");
    unit.variables.insert(at, "max=\"INF\" min=\"-INF\" nominal=\"NaN\" declaredType=\"nowhere\" ");
    if (const auto twice = unit.variables.find("min=\"0\"", at); unit.binary.ends_with('2'))
      unit.variables.erase(twice, 7);
    const auto description = read_model_description("m.fmu", description_of(unit));
    ASSERT_TRUE(description) << description.error().describe();
    EXPECT_FALSE(description->find("M")->max || description->find("M")->min || description->find("M")->nominal);
    EXPECT_EQ(description->find("M")->start, std::vector{20.0});
    std::string last = "20";
    for (const std::string start : {"INF", "-INF", "NaN", "1E400", "1E-400"}) {
      unit.variables = replaced(unit.variables, "start=\"" + last + "\"", "start=\"" + start + "\"");
      last = start;
      const auto without = read_model_description("m.fmu", description_of(unit));
      ASSERT_TRUE(without) << without.error().describe();
      EXPECT_EQ(without->find("M")->start, start == "1E-400" ? std::vector{0.0} : std::vector<double>()) << start;
    }
  }
}

TEST(ModelDescription, DraftsOfTheStandardAreRefusedByName) {
  for (const char* version : {"3.0-alpha.2", "3.0-beta.1", "3.1-rc.1"}) {
    TestUnit unit = spring_return("fmu_spring_return3");
    unit.version = version;
    const auto description = read_model_description("m.fmu", description_of(unit));
    ASSERT_FALSE(description);
    EXPECT_THAT(description.error().describe(), AllOf(HasSubstr(version), HasSubstr("is a draft of FMI")));
  }
  TestUnit unit = spring_return("fmu_spring_return3");
  unit.version = "3.0.2";
  EXPECT_TRUE(read_model_description("m.fmu", description_of(unit)));
}

}  // namespace
}  // namespace sealwatch::fmi
