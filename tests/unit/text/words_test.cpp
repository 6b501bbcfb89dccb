#include "services/common/text/words.hpp"

#include <gtest/gtest.h>

#include "services/common/text/law_words.hpp"

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
  EXPECT_EQ(in_words("pressure_dependent_friction"), "pressure-dependent friction");
  EXPECT_EQ(in_words("viscosity_warm_up"), "viscosity warm-up");
  EXPECT_EQ(in_words("lugre"), "LuGre");
}

TEST(Words, OfALawAtItsElement) {
  EXPECT_EQ(law_at("Coulomb friction", "piston", "the piston", "at"), "Coulomb friction at the piston");
  EXPECT_EQ(law_at("external leakage", "chamber_a", "chamber A", "of"), "external leakage of chamber A");
  EXPECT_EQ(law_at("entrained air", "fluid", "the fluid", "at"), "entrained air in the fluid");
  EXPECT_EQ(law_at("sensor bias", "sensor:pressure_a", "the sensor", "at"), "sensor bias of pressure A");
  EXPECT_EQ(law_at("input bias", "input:u", "the input", "of"), "input bias of the recorded u");
  EXPECT_EQ(law_at("clock rate", "clock", "the clock", "at"), "clock rate of the recording");
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
