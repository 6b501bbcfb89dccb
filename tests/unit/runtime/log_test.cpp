// Log lines, and the files they go to.
#include "services/common/runtime/log.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <future>

#include "tests/unit/runtime/yaml_place.hpp"

namespace sealwatch::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;

class LogTest : public ::testing::Test {
 protected:
  void start(const std::string& level = "info", double rotate_at_MB = 10.0, std::int32_t files = 5) {
    LoggingConfig config;
    config.level = level;
    config.directory = place_.directory() + "/log";
    config.rotate_at_MB = rotate_at_MB;
    config.rotated_files = files;
    ASSERT_TRUE(start_logging(config, "state_detection"));
  }
  void TearDown() override { stop_logging(); }
  [[nodiscard]] std::vector<std::string> lines(const std::string& name = "state_detection.log") const {
    std::ifstream stream(place_.directory() + "/log/" + name);
    std::vector<std::string> found;
    for (std::string line; std::getline(stream, line);) found.push_back(line);
    return found;
  }
  YamlPlace place_;
};

TEST_F(LogTest, ALineAboutATestNamesTestAssetAndMessage) {
  start();
  StateReport report;
  report.asset_id = "XT03-MV2";
  report.header.pst_id = "P1";
  report.header.message_id = "state_report/P1";
  log_message(LogLevel::info, "concluded", report, {{"verdict", "passed"}});
  ASSERT_EQ(lines().size(), 1U);
  EXPECT_THAT(
      lines()[0],
      MatchesRegex("[0-9-]*T[0-9:]*\\.[0-9][0-9][0-9]Z info state_detection concluded topic=state_report pst=P1 "
                   "asset=XT03-MV2 message=state_report/P1 verdict=passed"));
}

/// A service that waits for somebody who reads its log says nothing, not even that.
TEST_F(LogTest, APipeInItsPlaceIsRefusedByName) {
  const std::string directory = place_.directory() + "/log";
  std::filesystem::create_directory(directory);
  const std::string pipe = directory + "/state_detection.log";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  LoggingConfig config;
  config.directory = directory;
  auto started = std::async(std::launch::async, [&] { return start_logging(config, "state_detection"); });
  const bool done = started.wait_for(std::chrono::seconds(20)) == std::future_status::ready;
  const int other_end = ::open(pipe.c_str(), O_RDWR | O_CLOEXEC);  // lets go of who waits
  ASSERT_TRUE(done);
  const Status status = started.get();
  ::close(other_end);
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().describe(), HasSubstr("state_detection.log is a pipe"));
}

TEST_F(LogTest, AValueWithSpacesOrLineBreaksStaysOneField) {
  start();
  log_event(LogLevel::info, "odd", {{"a", "two words"}, {"b", "say \"x\""}, {"c", "two\nlines"}, {"d", ""}});
  ASSERT_EQ(lines().size(), 1U);
  EXPECT_THAT(lines()[0], HasSubstr("odd a=\"two words\" b=\"say \\\"x\\\"\" c=\"two lines\" d=\"\""));
}

TEST_F(LogTest, AnEndlessValueIsCutAndItsLengthTold) {
  start();
  log_event(LogLevel::info, "taken", {{"remark", std::string(1'000'000, 'x')}});
  ASSERT_EQ(lines().size(), 1U);
  EXPECT_LT(lines()[0].size(), 5000U);
  EXPECT_THAT(lines()[0], HasSubstr("xxx... (1000000 bytes)"));
}

TEST_F(LogTest, ForeignBracesAreNoFormat) {
  start();
  log_event(LogLevel::info, "{} {0} %s", {{"a", "{}"}});
  ASSERT_EQ(lines().size(), 1U);
  EXPECT_THAT(lines()[0], HasSubstr("{} {0} %s a={}"));
}

TEST_F(LogTest, WhatIsBelowTheLevelIsLeftOut) {
  start("warn");
  log_event(LogLevel::info, "quiet");
  log_event(LogLevel::warn, "loud");
  EXPECT_FALSE(logs(LogLevel::info));
  ASSERT_EQ(lines().size(), 1U);
  EXPECT_THAT(lines()[0], HasSubstr("warning state_detection loud"));
}

TEST_F(LogTest, AFullFileIsRenamedAndTheOldestGoes) {
  start("info", 0.001, 2);  // one kilobyte
  for (int k = 0; k < 100; ++k) log_event(LogLevel::info, "line", {{"number", std::to_string(k)}});
  stop_logging();
  EXPECT_FALSE(lines().empty());
  EXPECT_FALSE(lines("state_detection.1.log").empty());
  EXPECT_FALSE(lines("state_detection.2.log").empty());
  EXPECT_TRUE(lines("state_detection.3.log").empty());
  EXPECT_THAT(lines().back(), HasSubstr("number=99"));
  for (const char* name : {"state_detection.log", "state_detection.1.log", "state_detection.2.log"})
    EXPECT_LE(std::filesystem::file_size(place_.directory() + "/log/" + name), 1000U) << name;
}

/// As logrotate does, or whoever clears a directory.
TEST_F(LogTest, AFileThatOthersRenameReplaceOrRemoveIsBegunAnew) {
  start();
  const std::filesystem::path directory = place_.directory() + "/log", file = directory / "state_detection.log";
  log_event(LogLevel::info, "first");
  std::filesystem::rename(file, directory / "old.log");
  log_event(LogLevel::info, "second");
  ASSERT_EQ(lines().size(), 1U);
  EXPECT_THAT(lines()[0], MatchesRegex(".*Z info state_detection second"));
  EXPECT_EQ(lines("old.log").size(), 1U);
  std::filesystem::rename(file, directory / "older.log");
  std::ofstream(file).close();
  log_event(LogLevel::info, "third");
  EXPECT_EQ(lines().size(), 1U);
  std::filesystem::remove_all(directory);
  log_event(LogLevel::info, "fourth");
  EXPECT_EQ(lines().size(), 1U);
}

TEST_F(LogTest, SystemdsJournalIsToldThePriority) {
  ::setenv("JOURNAL_STREAM", "8:1", 1);
  start();
  ::unsetenv("JOURNAL_STREAM");
  ::testing::internal::CaptureStderr();
  log_event(LogLevel::info, "to the file alone");
  log_event(LogLevel::warn, "disk");
  log_event(LogLevel::error, "lost");
  const std::string told = ::testing::internal::GetCapturedStderr();
  EXPECT_THAT(told, MatchesRegex("<4>20[^\n]*Z warning state_detection disk\n<3>20[^\n]*Z error [^\n]*lost\n"));
  EXPECT_THAT(lines().at(1), MatchesRegex("20.*Z warning state_detection disk")) << "not in the file";
}

TEST_F(LogTest, ADirectoryThatCannotBeMadeIsNamed) {
  LoggingConfig config;
  config.directory = place_.write("file", "x") + "/log";
  const Status started = start_logging(config, "state_detection");
  ASSERT_FALSE(started);
  EXPECT_THAT(started.error().describe(), HasSubstr(config.directory + ": key logging.directory"));
}

}  // namespace
}  // namespace sealwatch::testing
