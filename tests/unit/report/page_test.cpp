#include "services/common/report/page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/report/well_formed.hpp"

namespace sealwatch::report {
namespace {

using ::testing::HasSubstr;

TEST(Page, EscapesWhatHtmlReads) {
  EXPECT_EQ(escaped("<script>alert(\"a\" & 'b')</script>"),
            "&lt;script&gt;alert(&quot;a&quot; &amp; &#39;b&#39;)&lt;/script&gt;");
  EXPECT_EQ(escaped("µm, L/min"), "µm, L/min");
}

TEST(Page, ReplacesWhatIsNoText) {
  EXPECT_EQ(escaped(std::string("a\0b\x1b", 4)), "a\uFFFDb\uFFFD");
  EXPECT_EQ(escaped("caf\xe9!"), "caf\uFFFD!");                        // Latin-1
  EXPECT_EQ(escaped("\xc0\xaf"), "\uFFFD\uFFFD");                      // overlong '/'
  EXPECT_EQ(escaped("\xed\xa0\x80").find('\xed'), std::string::npos);  // half of a surrogate pair
  EXPECT_EQ(escaped("end\xe2\x82"), "end\uFFFD\uFFFD");                // cut off
}

TEST(Page, IsWellFormed) {
  Table table({"channel", ">rms"});
  table.row({"<flow>", "1 & 2"});
  table.row_of_html({"<b>x</b>", "2"}, "strong");
  const std::string page = html_page(
      "A <b> & c", section("T & U", table.html().append(paragraph("a < b")).append(folded("more", "<p>x</p>"))));
  EXPECT_EQ(what_is_wrong(page), "");
  EXPECT_NE(page.find("<title>A &lt;b&gt; &amp; c</title>"), std::string::npos);
  EXPECT_NE(page.find("<td>&lt;flow&gt;</td><td class=\"n\">1 &amp; 2</td>"), std::string::npos);
}

TEST(Page, FiguresStayOnOneLineWhereATableIsNarrow) {
  EXPECT_EQ(unbroken("about 2021-04-15, then"), "about <span class=\"whole\">2021-04-15,</span> then");
  EXPECT_EQ(unbroken("100 (47.8\u2013100)"), "100 <span class=\"whole\">(47.8\u2013100)</span>");
  EXPECT_EQ(unbroken("well-known 36 "), "well-known 36 ");
  EXPECT_EQ(unbroken("below 60 %"), "below <span class=\"whole\">60 %</span>");
  EXPECT_EQ(unbroken("misfit, %"), "misfit, %");
  Table table({"date", ">of"});
  table.row({"2021-04-15", "1 \u00B1 2"});
  EXPECT_NE(table.html().find("<td><span class=\"whole\">2021-04-15</span></td><td class=\"n\">1 \u00B1 2</td>"),
            std::string::npos);
  EXPECT_EQ(what_is_wrong(html_page("t", table.html())), "");
}

TEST(Page, NeedsNoNetwork) {
  const std::string page = html_page("t", "");
  for (const char* fetched : {"http:", "https:", "src=", "href=", "@import", "url("})
    EXPECT_EQ(page.find(fetched), std::string::npos) << fetched;
}

TEST(Page, StylesOfDrawingsDoNotReachTheTextOfAPart) {
  const std::string page = html_page("t", folded_section("T", "inside", "<svg><text>x</text></svg>", Paper::printed));
  EXPECT_NE(page.find("<details class=\"part paper\">"), std::string::npos);
  EXPECT_EQ(page.find("\n.part{fill"), std::string::npos) << "text inside would inherit its stroke, and look smeared";
}

TEST(Page, AViewerWithoutVariablesDrawsInLightColours) {
  const std::string svg = standalone_svg("t", 9, 9, "<path class=\"ink-first stroke\" style=\"fill:var(--page)\"/>");
  for (const char* colour : {"style=\"fill:#fff;fill:var(--page)\"", "svg .tick{fill:#5c6670;fill:var(--muted)}",
                             ".ink-first.stroke{stroke:#0067a5;stroke:var(--first)}",
                             ".ink-first.fill,.ink-first.area{fill:#0067a5;fill:var(--first)}"})
    EXPECT_NE(svg.find(colour), std::string::npos) << colour;
  EXPECT_EQ(what_is_wrong(svg), "");
}

TEST(WellFormed, SeesWhatIsWrong) {
  EXPECT_NE(what_is_wrong("<p><b></p></b>"), "");
  EXPECT_NE(what_is_wrong("<p>a & b</p>"), "");
  EXPECT_NE(what_is_wrong("<p>a < b</p>"), "");
  EXPECT_NE(what_is_wrong("<p>"), "");
  EXPECT_NE(what_is_wrong("<p a=1></p>"), "");
  EXPECT_NE(what_is_wrong("<p a=\"1\" a=\"2\"></p>"), "");
}

TEST(Page, ATableOnPaperKeepsItsHeaderAndStaysTogetherWhereThatIsAsked) {
  Table table({"law", ">size"});
  table.row({"drag", "1.0"});
  EXPECT_THAT(table.html(), HasSubstr("<table>\n<thead>"));
  table.keep_together();
  EXPECT_THAT(table.html(), HasSubstr("<table class=\"together\">\n<thead>"));
  EXPECT_THAT(html_page("t", table.html()), HasSubstr("thead{display:table-header-group}"));
}

}  // namespace
}  // namespace sealwatch::report
