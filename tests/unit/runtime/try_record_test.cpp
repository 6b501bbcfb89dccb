#include "services/common/runtime/try_record.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdio>
#include <fstream>

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

// A map of a file that has no place on the disk ends the process where it is written to (SIGBUS), on a full disk.
TEST(TryRecord, HasItsPlaceOnTheDiskBeforeItIsWrittenTo) {
  const std::string file = ::testing::TempDir() + "tries-with-a-place";
  std::remove(file.c_str());
  TryRecord record;
  ASSERT_TRUE(record.keep_in(file));
  struct stat status {};
  ASSERT_EQ(::stat(file.c_str(), &status), 0);
  EXPECT_GT(status.st_size, 0);
  EXPECT_GE(512 * status.st_blocks, status.st_size);
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
