#include "services/common/report/plot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/unit/report/well_formed.hpp"

namespace sealwatch::report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

const double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(Ticks, AreRound) {
  EXPECT_THAT(nice_ticks(0.0, 10.0, 5), ElementsAre(0.0, 2.0, 4.0, 6.0, 8.0, 10.0));
  EXPECT_THAT(nice_ticks(-0.3, 0.3, 3),
              ElementsAre(testing::DoubleNear(-0.2, 1e-12), 0.0, testing::DoubleNear(0.2, 1e-12)));
  EXPECT_TRUE(nice_ticks(1.0, 1.0, 5).empty());
  EXPECT_TRUE(nice_ticks(0.0, std::numeric_limits<double>::infinity(), 5).empty());
}

TEST(Ticks, OfLogarithms) {
  EXPECT_THAT(logarithmic_ticks(0.9, 30.0), ElementsAre(1.0, 2.0, 5.0, 10.0, 20.0));
  EXPECT_EQ(logarithmic_ticks(1e-6, 1e6).front(), 1e-6);
  EXPECT_LE(logarithmic_ticks(1e-30, 1e30).size(), 10U);
  EXPECT_TRUE(logarithmic_ticks(-1.0, 1.0).empty());
}

TEST(Thinned, KeepsExtremesAndGaps) {
  std::vector<double> x, y;
  for (int k = 0; k < 10000; ++k) {
    x.push_back(k);
    y.push_back(std::sin(0.001 * k));
  }
  y[1234] = 7.0;  // a spike of one sample must be seen
  y[5678] = -7.0;
  for (int k = 8000; k < 8100; ++k) y[k] = kNaN;
  const auto [across, up] = thinned(x, y, 100);
  EXPECT_LE(up.size(), 2U * 100 + 4);
  EXPECT_EQ(*std::max_element(up.begin(), up.end(), [](double a, double b) { return !(a >= b) && std::isfinite(b); }),
            7.0);
  EXPECT_THAT(up, testing::Contains(-7.0));
  EXPECT_EQ(std::count_if(up.begin(), up.end(), [](double v) { return std::isnan(v); }), 1);
  EXPECT_TRUE(std::is_sorted(across.begin(), across.end()));
}

TEST(Thinned, LeavesShortLinesAlone) {
  const auto [across, up] = thinned({0.0, 1.0}, {3.0, 4.0}, 10);
  EXPECT_THAT(across, ElementsAre(0.0, 1.0));
  EXPECT_THAT(up, ElementsAre(3.0, 4.0));
}

Plot one_of_each() {
  Plot plot{.title = "chamber A <pressure>", .x = {.label = "time", .unit = "s"}, .y = {.unit = "Pa"}};
  plot.marks = {
      Band{.x = {0, 1, 2}, .low = {1e5, 2e5, 1e5}, .high = {3e5, 4e5, 3e5}, .label = "band & more"},
      Line{.x = {0, 1, 2}, .y = {2e5, kNaN, 2e5}, .label = "line", .dashed = true},
      Scatter{.x = {0.5, 1.5}, .y = {1e5, 2e5}, .label = "dots"},
      Bars{.edges = {0, 1, 2}, .heights = {1e5, 2e5}, .label = "bars"},
      Boxes{.boxes = {{.x = 1, .low = 0, .lower_quartile = 1e5, .median = 2e5, .upper_quartile = 3e5, .high = 4e5}}},
      Intervals{.x = {1}, .y = {1e5}, .low = {0.5e5}, .high = {2e5}},
      Reference{.at = 2e5, .label = "limit"},
      Reference{.at = 1.0, .vertical = true, .label = "<event>"}};
  return plot;
}

TEST(Plot, DrawsEveryMarkWellFormed) {
  const std::string svg = to_svg(one_of_each());
  EXPECT_EQ(what_is_wrong(svg), "") << svg;
  EXPECT_THAT(svg, HasSubstr("chamber A &lt;pressure&gt;, bar"));
  EXPECT_THAT(svg, HasSubstr("time, s"));
  EXPECT_THAT(svg, HasSubstr("band &amp; more"));
  EXPECT_THAT(svg, HasSubstr("limit"));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
  EXPECT_EQ(svg, to_svg(one_of_each()));
}

TEST(Plot, NamesOfVerticalLinesDoNotOverlap) {
  Plot plot{.x = {.range = {{0.0, 10.0}}}, .y = {.range = {{0.0, 1.0}}}};
  plot.marks = {Line{.x = {0.0, 10.0}, .y = {0.0, 1.0}},
                Reference{.at = 5.0, .vertical = true, .label = "act by 2018-05-31"},
                Reference{.at = 5.5, .vertical = true, .label = "summer 2019"},
                Reference{.at = 9.9, .vertical = true, .label = "summer 2021"}};
  const std::string svg = to_svg(plot);
  EXPECT_EQ(what_is_wrong(svg), "") << svg;
  EXPECT_THAT(svg, HasSubstr("y=\"11.0\" text-anchor=\"end\">act by 2018-05-31")) << "to the right is the next line";
  EXPECT_THAT(svg, HasSubstr("y=\"11.0\" >summer 2019"));
  EXPECT_THAT(svg, HasSubstr("y=\"11.0\" text-anchor=\"end\">summer 2021")) << "left of its line, where the plot ends";
}

TEST(Plot, ANameThatHasToCrossALineInterruptsIt) {
  Plot plot{.x = {.range = {{0.0, 10.0}}}, .y = {.range = {{0.0, 1.0}}}};
  plot.marks = {Line{.x = {0.0, 10.0}, .y = {0.0, 1.0}},
                Reference{.at = 1.0, .vertical = true, .label = "act by 2018-05-31"},
                Reference{.at = 1.5, .vertical = true, .label = "summer 2019"}};
  const std::string svg = to_svg(plot);
  EXPECT_EQ(what_is_wrong(svg), "") << svg;
  const std::size_t line = svg.rfind("<line"), paper = svg.find("class=\"paper\""), name = svg.find(">act by");
  ASSERT_NE(paper, std::string::npos);
  EXPECT_LT(line, paper);
  EXPECT_LT(paper, name);
  EXPECT_EQ(svg.find("class=\"paper\"", paper + 1), std::string::npos) << "summer 2019 crosses none";
}

TEST(Plot, PlacesValuesOnTheScale) {
  Plot plot{.x = {.range = {{0.0, 10.0}}}, .y = {.range = {{0.0, 1.0}}}, .width = 166, .height = 100};
  plot.x.tick_labels = false;
  plot.marks = {Line{.x = {0.0, 10.0}, .y = {0.0, 1.0}}};
  // frame: 54 left, 12 right, 6 above, 5 below: 100 by 89 pixels, y downwards
  EXPECT_THAT(to_svg(plot), HasSubstr("d=\"M0 89l100-89\""));
}

TEST(Plot, WithNothingToShowSaysSo) {
  Plot plot{.title = "t"};
  EXPECT_THAT(to_svg(plot), HasSubstr("no data"));
  plot.marks = {Line{.x = {0.0, 1.0}, .y = {kNaN, kNaN}}};
  EXPECT_THAT(to_svg(plot), HasSubstr("no data"));
  EXPECT_EQ(what_is_wrong(to_svg(plot)), "");
}

TEST(Plot, AConstantHasAnAxisToo) {
  Plot plot{.y = {.unit = "Pa"}};
  plot.marks = {Line{.x = {0.0, 1.0}, .y = {1e7, 1e7}}};
  EXPECT_THAT(to_svg(plot), Not(HasSubstr("nan")));
  EXPECT_THAT(to_svg(plot), HasSubstr(">100<"));
}

TEST(Plot, LogarithmicAxisLeavesOutWhatItCannotShow) {
  Plot plot{.y = {.logarithmic = true}};
  plot.marks = {Scatter{.x = {0.0, 1.0, 2.0}, .y = {0.0, 10.0, 1000.0}}};
  const std::string svg = to_svg(plot);
  EXPECT_THAT(svg, HasSubstr(">100<"));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
}

TEST(Plot, LongRecordingsStaySmall) {
  Line line;
  for (int k = 0; k < 200000; ++k) {
    line.x.push_back(0.005 * k);
    line.y.push_back(1e7 * std::sin(0.01 * k) + (k * 7919 % 101));
  }
  Plot plot;
  plot.marks = {line};
  EXPECT_LT(to_svg(plot).size(), 16000U);
}

TEST(Plot, AFlatStripStillShowsItsScale) {
  Plot strip{.height = 110};
  strip.marks = {Line{.x = {0.0, 1.0}, .y = {-21.0, 44.0}}};
  const std::string svg = to_svg(strip);
  EXPECT_THAT(svg, HasSubstr(">0<"));
  EXPECT_THAT(svg, testing::AnyOf(HasSubstr(">20<"), HasSubstr(">40<")));
}

TEST(Plot, CategoriesNameThePlaces) {
  Plot plot{.x = {.categories = {"ols", "bank & fleet"}}, .y = {.label = "error", .unit = "1"}};
  plot.marks = {Intervals{.x = {0.0, 1.0}, .y = {1.0, 2.0}, .low = {0.5, 1.0}, .high = {2.0, 3.0}}};
  EXPECT_THAT(to_svg(plot), HasSubstr("bank &amp; fleet"));
}

}  // namespace
}  // namespace sealwatch::report
