#include "sealwatch/core/visible_text.hpp"

#include <gtest/gtest.h>

namespace sealwatch {
namespace {

TEST(VisibleText, LeavesWhatIsVisible) {
  for (const char* text : {"", "XT03-MV2", "caf\xC3\xA9 \xE2\x82\xAC", "two\nlines\tand a tab"})
    EXPECT_EQ(visible(text), text);
  EXPECT_FALSE(is_visible("two\nlines"));
  EXPECT_TRUE(is_visible("two\nlines", true));
}

TEST(VisibleText, ShowsWhatATerminalWouldObey) {
  EXPECT_EQ(visible("\x1B[2J\x1B]0;title\x07"), "\\x1B[2J\\x1B]0;title\\x07");
  EXPECT_EQ(visible("XT03\rXT04"), "XT03\\x0DXT04");
  EXPECT_EQ(visible("a\xC2\x9B"
                    "31m"),
            "a\\xC2\\x9B31m")
      << "C1: an escape in two bytes";
  EXPECT_EQ(visible("ab\xE2\x80\xAE"
                    "dc"),
            "ab\\xE2\\x80\\xAEdc")
      << "right to left";
  EXPECT_EQ(visible("caf\xE9"), "caf\\xE9") << "Latin-1";
  EXPECT_EQ(visible("two\nlines", false), "two\\x0Alines");
  EXPECT_EQ(visible(std::string_view("\0x", 2)), "\\x00x");
  for (const char* bad : {"\xE2\x82", "\xC0\xAF", "\xE0\x80\xAF", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\x80"}) {
    EXPECT_FALSE(is_valid_utf8(bad));
    EXPECT_TRUE(is_visible(visible(bad)));
  }
}

/// "XT-1" and "XT-1" with something in between that nobody sees are two assets, and look like one.
TEST(VisibleText, ANameHasNothingThatNobodySees) {
  for (const char* unseen : {"\u200b", "\u200c", "\u200e", "\u200f", "\u061c", "\u2060", "\u2066", "\ufeff", "\u00ad",
                             "\u00a0", "\u2003", "\u3000", "\u3164", "\u2800", "\ufe0f", "\U000e0041"}) {
    const std::string name = "XT" + std::string(unseen) + "1";
    EXPECT_FALSE(is_visible(name)) << visible(name, false);
    EXPECT_TRUE(is_visible(visible(name, false)));
  }
  EXPECT_EQ(visible("z\u200bw"), "z\\xE2\\x80\\x8Bw");
  EXPECT_EQ(visible("J.\u00a0Silva: \u0645\u06cc\u200c\u0631\u0648\u0645"),
            "J.\u00a0Silva: \u0645\u06cc\u200c\u0631\u0648\u0645")
      << "running text";
  EXPECT_TRUE(is_visible("XT 1 \u00e9\u0645\u65e5"));
}

TEST(WithoutBlanks, LeavesWhatAReaderSees) {
  EXPECT_EQ(without_blanks(" J.\t Silva\n"), "J.Silva");
  EXPECT_EQ(without_blanks("J.\u00a0Si\u00adlva\u200b\u3000\ufeff\U000E0020"), "J.Silva");
  EXPECT_EQ(without_blanks("Müller-Łoś \xFC"), "Müller-Łoś\xFC") << "what is no UTF-8 stays";
  EXPECT_EQ(without_blanks("\u2060\u00a0"), "");
}

TEST(ShellWord, IsOneWordAndNothingIsObeyed) {
  EXPECT_EQ(shell_word("recommendation/XT03-MV2-20310412T030000Z-1a2b3c4d"),
            "recommendation/XT03-MV2-20310412T030000Z-1a2b3c4d");
  EXPECT_EQ(shell_word(""), "''");
  EXPECT_EQ(shell_word("$(reboot)"), "'$(reboot)'");
  EXPECT_EQ(shell_word("a; rm -rf ~"), "'a; rm -rf ~'");
  EXPECT_EQ(shell_word("it's `x`\n"), "'it'\\''s `x`\\x0A'");
}

}  // namespace
}  // namespace sealwatch
