#include "services/cli/terminal.hpp"

#include "services/cli/folded_name.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace sealwatch::cli {
namespace {

TEST(Terminal, NumbersKeepSignificantDigits) {
  EXPECT_EQ(number(0.0), "0");
  EXPECT_EQ(number(3.14159, 3), "3.14");
  EXPECT_EQ(number(-0.0421, 2), "-0.042");
  EXPECT_EQ(number(123456.0, 3), "123456");
  EXPECT_EQ(number(2.6e13, 3), "2.60e+13");
  EXPECT_EQ(number(1.0e-7, 2), "1.0e-07");
  EXPECT_EQ(percent(0.1234), "12.3 %");
}

TEST(FoldedName, IsTheSameForNamesThatLookAlike) {
  for (const auto& [one, other] :
       std::vector<std::pair<std::string, std::string>>{{"XT03-MV2", "xt03-mv2"},
                                                        {"Ventil-\u00C4", "ventil-a\u0308"},
                                                        {"\u1E69", "s\u0307\u0323"},  // both marks, in the other order
                                                        {"\u03A3\u03C2", "\u03C3\u03C3"},
                                                        {"\u0416\u0419", "\u0436\u0438\u0306"},
                                                        {"Stra\u00DFe", "STRASSE"},
                                                        {"5 \u212B", "5 \u00E5"}})
    EXPECT_EQ(folded_name(one), folded_name(other)) << one << ", " << other;
  for (const auto& [one, other] : std::vector<std::pair<std::string, std::string>>{
           {"A1", "A2"}, {"\u00C4", "A"}, {"A-B", "A_B"}, {"\u4E00", "\u4E01"}, {"\xff", "\xfe"}, {"", "a"}})
    EXPECT_NE(folded_name(one), folded_name(other)) << one << ", " << other;
}

TEST(Terminal, WrappedLinesStayWithinTheWidth) {
  const std::string text = wrapped("one two three four five six seven eight nine ten", 20, 4);
  EXPECT_EQ(text, "one two three\n    four five six\n    seven eight nine\n    ten");
  EXPECT_EQ(wrapped("", 20, 4), "");
  EXPECT_EQ(wrapped("averyveryverylongword", 10, 0), "averyveryverylongword");
}

TEST(Terminal, BarsTellNothingFromALittle) {
  EXPECT_EQ(bar(0.0, 4), "|    |");
  EXPECT_EQ(bar(0.01, 4), "|.   |");
  EXPECT_EQ(bar(0.0001, 4), "|    |");  // 0.0 %
  EXPECT_EQ(bar(0.5, 4), "|##  |");
  EXPECT_EQ(bar(2.0, 4), "|####|");
  EXPECT_EQ(bar(std::nan(""), 4), "|    |");
}

TEST(Terminal, PaddingCountsLettersNotBytes) {
  EXPECT_EQ(padded("v\xC3\xA5r", 5), "v\xC3\xA5r  ");
  EXPECT_EQ(padded("summer", 3), "summer");
}

TEST(Terminal, ChartShowsEachPointAndTheThreshold) {
  ChartOptions options;
  options.width = 5;
  options.height = 3;
  options.threshold = 0.0;
  options.threshold_label = "fails";
  options.x_low_label = "a";
  options.x_high_label = "b";
  EXPECT_EQ(chart({{0.0, 1.0}, {4.0, 0.5}}, options),
            "   1.0 |o    \n   0.5 |    o\n   0.0 |- - -  fails\n       +-----\n        a   b\n");
  EXPECT_EQ(chart({}, options), "");
}

TEST(ProgressLine, NeverCountsBeyondItsTotal) {
  ::testing::internal::CaptureStderr();
  Progress("replay", 1, "tests").show(2, "2031-04-12");  // a service concludes from a test of before, too
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), ::testing::HasSubstr("1 of 1 tests, 2031-04-12"));
  ::testing::internal::CaptureStderr();
  Progress("fit", 100, "%").show(17, "iteration 2");
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), ::testing::HasSubstr("17 %, iteration 2"));
}

}  // namespace
}  // namespace sealwatch::cli
