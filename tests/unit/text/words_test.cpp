#include "services/common/text/words.hpp"

#include <gtest/gtest.h>

namespace sealwatch::text {
namespace {

TEST(Words, OfIdentifiers) {
  EXPECT_EQ(in_words("not_judged"), "not judged");
  EXPECT_EQ(in_words("line_resistance"), "line resistance");
  EXPECT_EQ(in_words("sensor:pressure_a"), "sensor: pressure A");
  EXPECT_EQ(in_words("chamber_b"), "chamber B");
  EXPECT_EQ(in_words("y_w"), "y_w");
  EXPECT_EQ(in_words("sensor:p_a"), "sensor: p_a");
  EXPECT_EQ(in_words(""), "");
}

TEST(Words, OfLists) {
  EXPECT_EQ(joined({}), "");
  EXPECT_EQ(joined({"a"}, " and "), "a");
  EXPECT_EQ(joined({"a", "b", "c"}), "a, b, c");
  EXPECT_EQ(joined({"a", "b", "c"}, " and "), "a, b and c");
  EXPECT_EQ(separated({"a", "", "c"}), "a; ; c");
  EXPECT_EQ(count_of(1, "test"), "1 test");
  EXPECT_EQ(count_of(0, "test"), "0 tests");
}

TEST(Words, AreQuotedForYaml) {
  EXPECT_EQ(quoted("a \"b\" \\ c"), "\"a \\\"b\\\" \\\\ c\"");
  EXPECT_EQ(quoted("two\nlines"), "\"two lines\"");
}

TEST(Words, CountTheirLettersAsReadersDo) {
  EXPECT_EQ(letters("1.2·10¹³"), 8U);
  EXPECT_EQ(padded("µm", 4), "µm  ");
  EXPECT_EQ(padded("longer", 4), "longer");
  EXPECT_EQ(wrapped("one two three", 8, 2), "one\n  two\n  three");
  EXPECT_EQ(wrapped("is 60.0 % (limit)", 7, 0), "is\n60.0 %\n(limit)");
}

TEST(Words, AListGrowsPartByPart) {
  std::string text;
  add_to_list(text, "a");
  EXPECT_EQ(text, "a");
  add_to_list(text, "b");
  add_to_list(text, "c", "; ");
  EXPECT_EQ(text, "a, b; c");
}

}  // namespace
}  // namespace sealwatch::text
