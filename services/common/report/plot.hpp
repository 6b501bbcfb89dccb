// Plots as inline SVG for self-contained HTML pages.
//
//   Plot plot{.title = "chamber A pressure", .x = {.label = "time", .unit = "s"}, .y = {.unit = "Pa"}};
//   plot.marks.push_back(Line{.x = time, .y = pressure, .ink = Ink::foreground, .label = "recorded"});
//   html += to_svg(plot);
//
// Data are SI; each axis is written in its everyday unit (readable.hpp), with ticks at 1, 2 or 5 times a power of ten.
// Colours are classes of the page's style sheet (page.hpp), so that one drawing is legible in light, in dark and on
// paper. Long lines are thinned to the lowest and highest value of each column of pixels, which looks the same. Values
// that are not finite leave a gap. The same data give the same text.
//
// Left and right margins are the same in all plots of a width: plots put below each other share their x axis.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace sealwatch::report {

/// Colours of the page. first to fourth can be told apart by the colour-blind.
enum class Ink { foreground, muted, first, second, third, fourth, bad };

/// CSS class of an ink, "ink-first".
[[nodiscard]] std::string ink_class(Ink ink);

struct Line {
  std::vector<double> x = {}, y = {};
  Ink ink = Ink::first;
  std::string label = {};  ///< in the legend; "": not there
  double width = 1.4;      ///< pixels
  bool dashed = false;
};

/// The area between low and high.
struct Band {
  std::vector<double> x = {}, low = {}, high = {};
  Ink ink = Ink::first;
  std::string label = {};
};

struct Scatter {
  std::vector<double> x = {}, y = {};
  Ink ink = Ink::first;
  std::string label = {};
  double radius = 1.6;  ///< pixels
};

/// A histogram: heights.size() + 1 edges.
struct Bars {
  std::vector<double> edges = {}, heights = {};
  Ink ink = Ink::first;
  std::string label = {};
};

/// A box over x: quartiles and median, whiskers to low and high.
struct Box {
  double x = 0.0, low = 0.0, lower_quartile = 0.0, median = 0.0, upper_quartile = 0.0, high = 0.0;
};
struct Boxes {
  std::vector<Box> boxes = {};
  double width = 0.6;  ///< in units of x
  Ink ink = Ink::first;
  std::string label = {};
};

/// Intervals low..high over x, with a dot at y.
struct Intervals {
  std::vector<double> x = {}, y = {}, low = {}, high = {};
  Ink ink = Ink::first;
  std::string label = {};
};

/// A line across the whole plot, at a value of y, or of x when `vertical`.
struct Reference {
  double at = 0.0;
  bool vertical = false;
  Ink ink = Ink::muted;
  std::string label = {};      ///< beside the line
  bool named_at_left = false;  ///< of a line across: else its label is at the right end
};

using Mark = std::variant<Line, Band, Scatter, Bars, Boxes, Intervals, Reference>;

struct Axis {
  std::string label = {};                               ///< "time"
  std::string unit = {};                                ///< SI; "" or "1": plain numbers
  std::optional<std::pair<double, double>> range = {};  ///< SI; else what the marks need
  bool logarithmic = false;                             ///< marks at or below 0 are left out
  bool tick_labels = true;
  bool whole = false;                        ///< ticks at whole numbers only: years
  std::vector<std::string> categories = {};  ///< names of the places 0, 1, 2, ... instead of numbers
};

struct Plot {
  std::string title = {};
  Axis x = {}, y = {};
  std::vector<Mark> marks = {};  ///< drawn in this order
  int width = 460;               ///< pixels
  int height = 220;
  bool legend = true;
};

/// "<svg ...>...</svg>", all text escaped. A plot without a finite value says so.
[[nodiscard]] std::string to_svg(const Plot& plot);

/// About `about` round values within [low, high].
[[nodiscard]] std::vector<double> nice_ticks(double low, double high, int about);

/// Decades within [low, high], with 2 and 5 times a power of ten where there are fewer than three.
[[nodiscard]] std::vector<double> logarithmic_ticks(double low, double high);

/// The lowest and highest value of each of `columns` equal parts of the range of x, in the order of x, each run of
/// finite values for itself. x must not decrease. Shorter lines are returned as they are.
[[nodiscard]] std::pair<std::vector<double>, std::vector<double>> thinned(const std::vector<double>& x,
                                                                          const std::vector<double>& y,
                                                                          std::size_t columns);

}  // namespace sealwatch::report
