// `sealwatch laws` and `sealwatch plant show`: what they print is what the code has, complete and within a page's width.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "sealwatch/model/physics.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "services/cli/commands.hpp"

namespace sealwatch::cli {
namespace {

using CatalogueJson = nlohmann::json;
using ::testing::ContainsRegex;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::size_t kWidest = 100;

struct Printed {
  int status = 0;
  std::string out, err;
};

Printed printed_by(const std::function<int()>& command) {
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  const int status = command();
  return {status, ::testing::internal::GetCapturedStdout(), ::testing::internal::GetCapturedStderr()};
}

Printed laws(const std::string& asked, bool as_json = false) {
  return printed_by([&] { return run_laws({.asked = asked, .json = as_json}); });
}

Printed plant(const std::string& name, bool as_json = false) {
  return printed_by([&] { return run_plant_show({.name = name, .json = as_json}); });
}

std::string as_one_line(const std::string& text) {
  std::istringstream words(text);
  std::string line, word;
  while (words >> word) line += (line.empty() ? "" : " ") + word;
  return line;
}

void expect_lines_fit(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), kWidest) << line;
}

std::vector<std::string> ids_in(const std::string& text) {
  std::vector<std::string> ids;
  const CatalogueJson shown = CatalogueJson::parse(text);
  for (const CatalogueJson& law : shown["laws"])
    if (std::ranges::find(ids, law["id"].get<std::string>()) == ids.end()) ids.push_back(law["id"]);
  return ids;
}

TEST(LawsCommand, ShowsEveryLawWithItsParametersWithinAPage) {
  const Printed all = laws("");
  EXPECT_EQ(all.status, kOk);
  expect_lines_fit(all.out);
  const std::string text = as_one_line(all.out);
  for (const Law& law : all_laws()) {
    EXPECT_THAT(text, HasSubstr(std::string(law.id) + (law.form.empty() ? "" : ", ") + std::string(law.form)));
    EXPECT_THAT(text, HasSubstr(std::string(law.equation) + " " + std::string(law.meaning))) << law.id;
    for (const LawParameter& parameter : law.parameters)
      EXPECT_THAT(text, HasSubstr(std::string(parameter.name) + " [" + std::string(parameter.unit) + "] " +
                                  std::string(parameter.meaning) + ": "))
          << law.id;
  }
}

TEST(LawsCommand, JsonHasEveryNumberOfTheCatalogue) {
  const CatalogueJson listed = CatalogueJson::parse(laws("", true).out)["laws"];
  EXPECT_EQ(listed.size(), all_laws().size());
  for (const Law& law : all_laws()) {
    const auto found = std::ranges::find_if(listed, [&](const CatalogueJson& one) {
      return one["id"] == law.id && one["form"] == law.form && one["equation"] == law.equation;
    });
    ASSERT_NE(found, listed.end()) << law.id << " " << law.form;
    ASSERT_EQ((*found)["parameters"].size(), law.parameters.size()) << law.id;
    for (std::size_t k = 0; k < law.parameters.size(); ++k) {
      const CatalogueJson& parameter = (*found)["parameters"][k];
      EXPECT_EQ(parameter["name"], law.parameters[k].name);
      EXPECT_EQ(parameter["tried"], law.parameters[k].start);
      EXPECT_EQ(parameter["significant"], law.parameters[k].significant);
      EXPECT_EQ(parameter["min"], law.parameters[k].min);
      EXPECT_EQ(parameter["max"], law.parameters[k].max);
    }
  }
}

TEST(LawsCommand, TakesAnIdAnElementOrAKindOfSite) {
  EXPECT_THAT(ids_in(laws("coulomb_friction", true).out), ElementsAre("coulomb_friction"));
  const std::vector<std::string> at_piston = ids_in(laws("piston", true).out);
  EXPECT_THAT(at_piston, ::testing::Contains("coulomb_friction"));
  EXPECT_THAT(at_piston, Not(::testing::Contains("sensor_bias")));
  EXPECT_EQ(ids_in(laws("piston_force", true).out), at_piston);
  EXPECT_THAT(ids_in(laws("sensor:position", true).out), ::testing::Contains("sensor_lag"));
  EXPECT_THAT(ids_in(laws("clock", true).out), ElementsAre("clock_rate"));
  EXPECT_THAT(ids_in(laws("input:motor_voltage", true).out), ::testing::Contains("input_clock_rate"));
}

TEST(LawsCommand, OneLawTellsItsSourceAndWhatKeepsItPhysical) {
  const Printed one = laws("quadratic_drag");
  EXPECT_THAT(one.out, HasSubstr("source: Merritt"));
  EXPECT_THAT(one.out, HasSubstr("physical while: k >= 0"));
  EXPECT_THAT(as_one_line(one.out), HasSubstr("usual 1e+09, matters from 3.4e+08, range 0 to 1e+12"));
  EXPECT_THAT(one.out, HasSubstr("v velocity [m/s]"));
}

TEST(LawsCommand, AnUnknownNameIsAnErrorWithTheNearest) {
  const Printed wrong = laws("coulomb_frction");
  EXPECT_EQ(wrong.status, kBadInput);
  EXPECT_THAT(wrong.err, HasSubstr("coulomb_friction"));
  EXPECT_THAT(laws("pistn").err, HasSubstr("did you mean 'piston'"));
}

TEST(PlantShow, HasEveryRowOfTheBuiltInPlants) {
  for (const PlantDescription& description : all_plants()) {
    if (!description.file.empty()) continue;
    const Printed shown = plant(description.name);
    EXPECT_EQ(shown.status, kOk);
    expect_lines_fit(shown.out);
    const std::string text = as_one_line(shown.out);
    for (const StateDescription& state : description.states)
      EXPECT_THAT(text, HasSubstr(state.name + " [" + state.unit + "] " + state.meaning));
    for (const ChannelDescription& channel : description.channels)
      EXPECT_THAT(text, HasSubstr(channel.name + " [" + channel.unit + "] ")) << description.name;
    for (const ElementDescription& element : description.elements) {
      if (element.name.starts_with("sensor:")) continue;
      EXPECT_THAT(text, HasSubstr(element.name + " " + element.meaning));
    }
  }
}

TEST(PlantShow, JsonHasEveryNumberOfTheBuiltInPlants) {
  for (const PlantDescription& description : all_plants()) {
    if (!description.file.empty()) continue;
    const CatalogueJson shown = CatalogueJson::parse(plant(description.name, true).out);
    ASSERT_EQ(shown["parameters"].size(), description.parameters.size());
    for (std::size_t k = 0; k < description.parameters.size(); ++k) {
      const ParameterDescription& parameter = description.parameters[k];
      EXPECT_EQ(shown["parameters"][k], (CatalogueJson{{"name", parameter.name},
                                                       {"unit", parameter.unit},
                                                       {"value", parameter.value},
                                                       {"min", parameter.min},
                                                       {"max", parameter.max},
                                                       {"tolerance", parameter.tolerance},
                                                       {"estimate", parameter.estimate},
                                                       {"meaning", parameter.meaning}}));
    }
    EXPECT_EQ(shown["inputs"].size() + shown["outputs"].size(), description.channels.size());
    EXPECT_EQ(shown["elements"].size(), description.elements.size());
  }
}

TEST(PlantShow, ListsSitesWithTheirLaws) {
  EXPECT_THAT(as_one_line(plant("eha").out),
              ContainsRegex("piston .* piston_force \\[N\\]: backlash, constant_force, coulomb_friction, "));
}

TEST(PlantShow, ShowsAPlantAsText) {
  const Printed shown = plant(SEALWATCH_SOURCE_DIR "/config/plants/spring_return.yaml");
  EXPECT_EQ(shown.status, kOk);
  expect_lines_fit(shown.out);
  EXPECT_THAT(shown.out, HasSubstr("Plant spring_return"));
  EXPECT_THAT(shown.out, Not(HasSubstr("pressure_dependent_friction"))) << "it has no pressures";
}

TEST(PlantShow, AnUnknownNameIsAnErrorWithTheNearest) {
  const Printed wrong = plant("eha_swiched");
  EXPECT_EQ(wrong.status, kBadInput);
  EXPECT_THAT(wrong.err, HasSubstr("eha_switched"));
  EXPECT_EQ(plant("no_such_file.yaml").status, kBadInput);
}

}  // namespace
}  // namespace sealwatch::cli
