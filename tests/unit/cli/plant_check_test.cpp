// `sealwatch plant check` says what it understood of each plant that comes as text.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "services/cli/commands.hpp"

namespace sealwatch::cli {
namespace {

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

TEST(PlantCheck, LawsThatCannotActAreNotListedAndSizesAreThoseOfThePlant) {
  const std::string told = told_of("emps.yaml");
  EXPECT_THAT(told, ::testing::HasSubstr("coulomb_friction"));
  EXPECT_THAT(told, ::testing::Not(::testing::HasSubstr("pressure_dependent_friction"))) << "it has no pressures";
  EXPECT_THAT(told, ::testing::ContainsRegex("N +x 0.0025 "));
}

}  // namespace
}  // namespace sealwatch::cli
