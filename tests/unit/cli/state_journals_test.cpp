// Where the services' journals are looked for.
#include "services/cli/state_journals.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace sealwatch::cli {
namespace {

namespace fs = std::filesystem;
using ::testing::EndsWith;

TEST(StateJournals, AreFoundInOneDirectoryAndWhereEachServiceHasItsOwn) {
  const fs::path state = fs::temp_directory_path() / ("sealwatch_state_" + std::to_string(::getpid()));
  fs::create_directories(state / "state-detection");
  std::ofstream(state / "state-detection" / "state_detection.db") << "a journal";
  std::ofstream(state / "data_acquisition.db") << "a journal";
  const auto found = journal_connections(state.string(), (state / "no_configuration").string());
  ASSERT_TRUE(found);
  EXPECT_THAT(found->at("state_detection"), EndsWith("/state-detection/state_detection.db"));
  EXPECT_FALSE(is_missing(found->at("state_detection")));
  EXPECT_EQ(found->at("data_acquisition"), "sqlite3://" + (state / "data_acquisition.db").string());
  EXPECT_EQ(found->at("health_assessment"), "sqlite3://" + (state / "health_assessment.db").string());
  EXPECT_TRUE(is_missing(found->at("health_assessment")));
  fs::remove_all(state);
}

}  // namespace
}  // namespace sealwatch::cli
