#include "services/common/runtime/try_record.hpp"

#include <gtest/gtest.h>

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
