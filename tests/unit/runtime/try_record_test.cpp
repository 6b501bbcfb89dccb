#include "services/common/runtime/try_record.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

namespace sealwatch {
namespace {

/// An entry as a former version reads it.
struct Former {
  std::uint64_t message;
  std::uint32_t failures;
  std::uint32_t at_work;
};

/// The only entry in use.
Former entry_in(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  for (Former entry{}; in.read(reinterpret_cast<char*>(&entry), sizeof entry);)
    if (entry.message != 0) return entry;
  return {};
}

/// In a process with a full disk of its own: 0 where the record says that there is no room, 1 where it is kept, 2 where
/// such a disk cannot be made here.
int keep_on_a_full_disk(const std::string& directory) {
  constexpr int kCannot = 2;
  if (::unshare(CLONE_NEWNS) != 0 && ::unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) return kCannot;
  if (::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) return kCannot;
  if (::mount("tmpfs", directory.c_str(), "tmpfs", 0, "size=4k") != 0) return kCannot;
  std::ofstream(directory + "/full") << "all of it";
  TryRecord record;
  const Status kept = record.keep_in(directory + "/tries");
  if (kept) return 1;
  return kept.error().describe().find("No space left on device; free some space on the disk") == std::string::npos;
}

// A map of a file that has no place on the disk ends the process where it is written to (SIGBUS).
TEST(TryRecord, OnAFullDiskItSaysSo) {
  const std::string directory = ::testing::TempDir() + "tries on a full disk";
  std::filesystem::create_directories(directory);
  const pid_t child = ::fork();
  if (child == 0) ::_exit(keep_on_a_full_disk(directory));
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status)) << "ended by signal " << WTERMSIG(status);
  if (WEXITSTATUS(status) == 2) GTEST_SKIP() << "no file system may be mounted here";
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

// After a return to the former version a message with deaths had 65 536 failures, and was set aside untried.
TEST(TryRecord, AFormerVersionTakesDeathsForNoFailures) {
  const std::string file = ::testing::TempDir() + "tries";
  std::remove(file.c_str());
  for (int death = 0; death < 7; ++death) {
    auto* const dies = new TryRecord;  // never destroyed: what it works on has died
    ASSERT_TRUE(dies->keep_in(file));
    if (death == 0) dies->fail("a");
    dies->begin("a");
  }
  EXPECT_EQ(entry_in(file).failures, 1U);
  EXPECT_NE(entry_in(file).at_work, 0U);
  TryRecord again;
  ASSERT_TRUE(again.keep_in(file));
  EXPECT_EQ(again.tries("a").failures, 1U);
  EXPECT_EQ(again.tries("a").deaths, 7U);
}

}  // namespace
}  // namespace sealwatch
