// Each kind of mark as SVG elements.
#include <algorithm>
#include <cmath>

#include "services/common/report/page.hpp"
#include "services/common/report/plot_scale.hpp"
#include "services/common/text/format.hpp"

namespace sealwatch::report {
namespace {

constexpr double kLetter = 6.1;  ///< mean width of a letter of a name, pixels

/// A path in tenths of a pixel, relative moves: a third of the length of absolute decimals. Rounding does not add up,
/// as each move starts from the rounded place.
class Path {
 public:
  void lift() { drawing_ = false; }
  void to(double x, double y) {
    if (!std::isfinite(x) || !std::isfinite(y)) return lift();
    const long long next_x = std::llround(10.0 * std::clamp(x, -kFar, kFar));
    const long long next_y = std::llround(10.0 * std::clamp(y, -kFar, kFar));
    if (!drawing_) {
      data_ += 'M';
      append(next_x);
      append(next_y);
    } else if (next_x != x_ || next_y != y_) {
      data_ += 'l';
      append(next_x - x_);
      append(next_y - y_);
    }
    drawing_ = true;
    x_ = next_x;
    y_ = next_y;
  }
  void close() { data_ += 'Z'; }
  [[nodiscard]] const std::string& data() const { return data_; }

 private:
  static constexpr double kFar = 1e5;  ///< far outside of any plot

  void append(long long tenths) {
    const bool first = !data_.empty() && std::isalpha(static_cast<unsigned char>(data_.back())) != 0;
    if (tenths >= 0 && !first) data_ += ' ';
    if (tenths < 0) data_ += '-';
    const long long size = std::llabs(tenths);
    if (size >= 10 || size == 0) data_ += std::to_string(size / 10);
    if (size % 10 != 0) data_.append(".").append(std::to_string(size % 10));
  }

  std::string data_;
  long long x_ = 0, y_ = 0;
  bool drawing_ = false;
};

std::string element(std::string_view name, const std::string& css_class, const std::string& attributes) {
  return std::string("<")
      .append(name)
      .append(" class=\"")
      .append(css_class)
      .append("\" ")
      .append(attributes)
      .append("/>\n");
}

std::string with(std::string_view name, double value) {
  return std::string(name).append("=\"").append(pixel(value)).append("\" ");
}

std::string segment(Ink ink, double x1, double y1, double x2, double y2, std::string_view more = {}) {
  return element("line", ink_class(ink).append(" stroke"),
                 with("x1", x1).append(with("y1", y1)).append(with("x2", x2)).append(with("y2", y2)).append(more));
}

std::string rectangle(const std::string& css_class, double x, double y, double width, double height) {
  return element("rect", css_class,
                 with("x", x).append(with("y", y)).append(with("width", width)).append(with("height", height)));
}

/// Names of lines, drawn over all marks; those of vertical lines each in the first row in which it overlaps no other.
class Names {
 public:
  explicit Names(std::vector<double> vertical_lines) : lines_(std::move(vertical_lines)) {}

  /// How many vertical lines a name between these pixels would cross.
  [[nodiscard]] std::size_t crossed(double left, double right) const {
    return static_cast<std::size_t>(
        std::ranges::count_if(lines_, [&](double at) { return left <= at && at <= right; }));
  }
  /// Baseline below the top, in pixels.
  double baseline(double left, double right) {
    std::size_t row = 0;
    const auto free = [&](const std::pair<double, double>& other) {
      return right < other.first || left > other.second;
    };
    while (row < rows_.size() && !std::ranges::all_of(rows_[row], free)) ++row;
    if (row == rows_.size()) rows_.emplace_back();
    rows_[row].emplace_back(left, right);
    return 11.0 + 13.0 * static_cast<double>(row);
  }
  /// A line that has to be crossed is interrupted.
  void interrupt_lines(double left, double right, double baseline) {
    if (crossed(left, right) > 0) svg_ += rectangle("paper", left, baseline - 10.0, right - left, 13.0);
  }
  void add(const std::string& label, double text_x, double text_y, bool ends) {
    svg_.append("<text class=\"tick named\" ")
        .append(with("x", text_x))
        .append(with("y", text_y))
        .append(ends ? "text-anchor=\"end\">" : ">")
        .append(escaped(label))
        .append("</text>\n");
  }
  [[nodiscard]] const std::string& svg() const { return svg_; }

 private:
  std::vector<double> lines_;
  std::string svg_;
  std::vector<std::vector<std::pair<double, double>>> rows_;
};

struct Draw {
  const Scale& x;
  const Scale& y;
  Names& names;

  [[nodiscard]] std::size_t columns() const { return static_cast<std::size_t>(std::abs(x.to - x.from)); }

  std::string operator()(const Line& line) const {
    const auto [across, up] = thinned(line.x, line.y, columns());
    Path path;
    for (std::size_t k = 0; k < across.size(); ++k) path.to(x(across[k]), y(up[k]));
    std::string more = std::string("d=\"").append(path.data()).append("\" ").append(with("stroke-width", line.width));
    if (line.dashed) more += "stroke-dasharray=\"5 3\" ";
    return element("path", ink_class(line.ink).append(" stroke"), more.append("stroke-linejoin=\"round\""));
  }

  std::string operator()(const Band& band) const {
    const auto [x_high, high] = thinned(band.x, band.high, columns() / 2);
    const auto [x_low, low] = thinned(band.x, band.low, columns() / 2);
    Path path;
    for (std::size_t k = 0; k < x_high.size(); ++k)
      if (std::isfinite(high[k])) path.to(x(x_high[k]), y(high[k]));
    for (std::size_t k = x_low.size(); k-- > 0;)
      if (std::isfinite(low[k])) path.to(x(x_low[k]), y(low[k]));
    if (path.data().empty()) return {};
    path.close();
    return element("path", ink_class(band.ink).append(" area"), std::string("d=\"").append(path.data()).append("\""));
  }

  /// Points as one path of dots: a line of no length with round ends.
  std::string operator()(const Scatter& points) const {
    Path path;
    std::string data;
    for (std::size_t k = 0; k < std::min(points.x.size(), points.y.size()); ++k) {
      path.lift();
      path.to(x(points.x[k]), y(points.y[k]));
    }
    for (const char letter : path.data()) {
      if (letter == 'M' && !data.empty()) data += "h0";
      data += letter;
    }
    if (data.empty()) return {};
    return element("path", ink_class(points.ink).append(" stroke"),
                   std::string("d=\"")
                       .append(data)
                       .append("h0\" ")
                       .append(with("stroke-width", 2.0 * points.radius))
                       .append("stroke-linecap=\"round\" stroke-opacity=\".55\""));
  }

  std::string operator()(const Bars& bars) const {
    std::string svg;
    for (std::size_t k = 0; k < bars.heights.size() && k + 1 < bars.edges.size(); ++k) {
      const double left = x(bars.edges[k]);
      const double right = x(bars.edges[k + 1]);
      const double top = y(bars.heights[k]);
      const double base = y.logarithmic ? y.from : y(0.0);
      if (!std::isfinite(left) || !std::isfinite(right) || !std::isfinite(top)) continue;
      svg += rectangle(ink_class(bars.ink).append(" fill"), left + 0.5, std::min(top, base),
                       std::max(right - left - 1.0, 0.5), std::abs(base - top));
    }
    return svg;
  }

  std::string operator()(const Boxes& boxes) const {
    std::string svg;
    for (const Box& box : boxes.boxes) {
      const double middle = x(box.x);
      const double left = x(box.x - boxes.width / 2.0);
      const double width = x(box.x + boxes.width / 2.0) - left;
      const double top = y(box.upper_quartile);
      const double bottom = y(box.lower_quartile);
      if (!std::isfinite(middle + width + top + bottom + y(box.low) + y(box.high))) continue;
      svg += segment(boxes.ink, middle, y(box.low), middle, bottom);
      svg += segment(boxes.ink, middle, top, middle, y(box.high));
      svg += rectangle(ink_class(boxes.ink).append(" area"), left, top, width, bottom - top);
      svg += rectangle(ink_class(boxes.ink).append(" stroke"), left, top, width, bottom - top);
      svg += segment(boxes.ink, left, y(box.median), left + width, y(box.median), "stroke-width=\"2\"");
    }
    return svg;
  }

  std::string operator()(const Intervals& intervals) const {
    std::string svg;
    const std::size_t size = std::min({intervals.x.size(), intervals.low.size(), intervals.high.size()});
    for (std::size_t k = 0; k < size; ++k) {
      const double middle = x(intervals.x[k]);
      if (std::isfinite(middle + y(intervals.low[k]) + y(intervals.high[k])))
        svg += segment(intervals.ink, middle, y(intervals.low[k]), middle, y(intervals.high[k]));
      if (k < intervals.y.size() && std::isfinite(middle + y(intervals.y[k])))
        svg += element("circle", ink_class(intervals.ink).append(" fill"),
                       with("cx", middle).append(with("cy", y(intervals.y[k]))).append("r=\"2.6\""));
    }
    return svg;
  }

  std::string operator()(const Reference& line) const {
    const double at = line.vertical ? x(line.at) : y(line.at);
    if (!std::isfinite(at)) return {};
    if (!line.label.empty() && line.vertical) name_beside(line, at);
    if (!line.label.empty() && !line.vertical)
      names.add(line.label, line.named_at_left ? 4.0 : x.to - 4.0, std::max(at - 4.0, 10.0), !line.named_at_left);
    return line.vertical ? segment(line.ink, at, y.from, at, y.to, "stroke-dasharray=\"4 3\"")
                         : segment(line.ink, x.from, at, x.to, at, "stroke-dasharray=\"4 3\"");
  }

  /// Right of the line; left of it where the plot ends, or where fewer other lines are crossed.
  void name_beside(const Reference& line, double at) const {
    constexpr double kGap = 4.0;
    const double width = kLetter * static_cast<double>(line.label.size());
    const double right = at + kGap, left = at - kGap - width;
    const bool ends = right + width > x.to ||
                      (left >= x.from && names.crossed(left, left + width) < names.crossed(right, right + width));
    const double begin = ends ? left : right, baseline = y.to + names.baseline(begin, begin + width);
    names.interrupt_lines(begin, begin + width, baseline);
    names.add(line.label, ends ? at - kGap : begin, baseline, ends);
  }
};

}  // namespace

std::string pixel(double value) { return text::format("{:.1f}", std::abs(value) < 0.05 ? 0.0 : value); }

std::string svg_of_marks(const Plot& plot, const Scale& x, const Scale& y) {
  std::string svg;
  std::vector<double> vertical_lines;
  for (const Mark& mark : plot.marks)
    if (const auto* line = std::get_if<Reference>(&mark); line != nullptr && line->vertical)
      vertical_lines.push_back(x(line->at));
  Names names(std::move(vertical_lines));
  for (const Mark& mark : plot.marks) svg += std::visit(Draw{x, y, names}, mark);
  return svg.append(names.svg());
}

}  // namespace sealwatch::report
