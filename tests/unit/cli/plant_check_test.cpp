// `sealwatch plant check` says what it understood of each plant that comes as text.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "sealwatch/model/plant_description.hpp"
#include "services/cli/commands.hpp"
#include "services/common/runtime/plant_file.hpp"
#include "tests/unit/runtime/yaml_place.hpp"

namespace sealwatch::cli {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string told_of(const std::string& plant) {
  ::testing::internal::CaptureStdout();
  const int status = run_plant_check({.file = std::string(SEALWATCH_SOURCE_DIR) + "/config/plants/" + plant});
  std::string told = ::testing::internal::GetCapturedStdout();
  EXPECT_EQ(status, kOk) << plant;
  return told;
}

TEST(PlantCheck, EveryPlantOfTheTreeIsUnderstood) {
  for (const auto& entry : std::filesystem::directory_iterator(std::string(SEALWATCH_SOURCE_DIR) + "/config/plants"))
    EXPECT_THAT(told_of(entry.path().filename().string()), ::testing::HasSubstr("valid: plant "));
}

// 60000 N, not 6e+04 N.
TEST(PlantCheck, NumbersUpToTenMillionHaveNoExponent) {
  for (const auto& entry : std::filesystem::directory_iterator(std::string(SEALWATCH_SOURCE_DIR) + "/config/plants"))
    EXPECT_THAT(told_of(entry.path().filename().string()), Not(::testing::ContainsRegex("[0-9]e\\+0[0-6]")))
        << entry.path();
}

TEST(PlantCheck, LawsThatCannotActAreNotListedAndSizesAreThoseOfThePlant) {
  const std::string told = told_of("emps.yaml");
  EXPECT_THAT(told, ::testing::HasSubstr("coulomb_friction"));
  EXPECT_THAT(told, ::testing::Not(::testing::HasSubstr("pressure_dependent_friction"))) << "it has no pressures";
  EXPECT_THAT(told, ::testing::ContainsRegex("N +x 0.0025 +of about 60000 N \\(load on its rod\\)"));
}

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

/// Laws go by what a command's voltage feeds, not by the name of its element.
TEST(PlantCheck, LawsOfADriveAndOfAPumpAreTriedAtAnyElement) {
  const sealwatch::testing::YamlPlace place;
  const std::filesystem::path own = std::string(SEALWATCH_SOURCE_DIR) + "/config/plants/spring_return.yaml";
  const std::string named = replaced(text_of(own), "name: spring_return_text", "name: other");
  const std::string text = replaced(replaced(named, "  driver:", "  amplifier:"), " feeds: motor,", "");
  const auto told = [&](const std::string& plant) {
    ::testing::internal::CaptureStdout();
    EXPECT_EQ(run_plant_check({.file = place.write("other.yaml", plant)}), kOk);
    return ::testing::internal::GetCapturedStdout();
  };
  EXPECT_THAT(told(text), AllOf(HasSubstr("driver_dead_time"), HasSubstr("pump_dead_voltage")));
  const std::string site = "{kind: voltage_command,";
  EXPECT_THAT(told(replaced(text, site, site + " feeds: motor,")),
              AllOf(HasSubstr("driver_dead_time"), Not(HasSubstr("pump_dead_voltage"))));
  EXPECT_THAT(told(replaced(text, site, site + " feeds: pump,")),
              AllOf(Not(HasSubstr("driver_dead_time")), HasSubstr("pump_dead_voltage")));
}

TEST(PlantExport, WritesABuiltInPlantByItsText) {
  const sealwatch::testing::YamlPlace place;
  const std::string asset =
      place.write("a.yaml",
                  "asset_id: D\nmodel: emps\nphysics:\n  - {id: coulomb_friction, element: piston, "
                  "parameters: {F_c: 20.0, v_s: 1.0e-3}}\n");
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(run_plant_export({.asset_file = asset, .fmu = place.directory() + "/out.fmu"}), kOk);
  EXPECT_THAT(::testing::internal::GetCapturedStdout(), HasSubstr("FMI 2.0"));
  EXPECT_TRUE(std::filesystem::exists(place.directory() + "/out.fmu"));
}

TEST(PlantExport, ABuiltInPlantHasTheParametersOfItsText) {
  int built_in = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(SEALWATCH_SOURCE_DIR) + "/config/plants")) {
    const auto plant = find_plant(entry.path().stem().string());
    if (!plant) continue;
    ++built_in;
    const auto text = read_plant_file(entry.path().string());
    ASSERT_TRUE(text) << text.error().front().describe();
    const auto& rows = text->built.plant.description.parameters;
    ASSERT_EQ(rows.size(), (*plant)->parameters.size());
    for (std::size_t k = 0; k < rows.size(); ++k) {
      EXPECT_EQ(rows[k].name, (*plant)->parameters[k].name);
      EXPECT_EQ(rows[k].unit, (*plant)->parameters[k].unit);
    }
  }
  EXPECT_EQ(built_in, 4);
}

}  // namespace
}  // namespace sealwatch::cli
