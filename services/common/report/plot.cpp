#include "services/common/report/plot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/common/report/page.hpp"
#include "services/common/report/plot_scale.hpp"

namespace sealwatch::report {
namespace {

constexpr double kLeft = 54.0;
constexpr double kRight = 12.0;
constexpr double kLetter = 6.1;  ///< mean width of a letter at 11 px
constexpr double kSample = 18.0;

/// The rectangle of a plot in which marks are drawn.
struct Frame {
  double left = kLeft, top = 0.0, width = 0.0, height = 0.0;
};

struct LegendEntry {
  Ink ink;
  std::string label;
  bool dashed = false;
  bool area = false;
  bool dot = false;
  bool interval = false;  ///< a dot on an upright line
};

/// Letters of UTF-8 text.
double letters(const std::string& text) {
  return static_cast<double>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::vector<LegendEntry> legend_of(const Plot& plot) {
  std::vector<LegendEntry> entries;
  if (!plot.legend) return entries;
  for (const Mark& mark : plot.marks)
    std::visit(
        [&entries](const auto& one) {
          using Kind = std::decay_t<decltype(one)>;
          if constexpr (!std::is_same_v<Kind, Reference>) {
            if (one.label.empty()) return;
            LegendEntry entry{.ink = one.ink, .label = one.label};
            if constexpr (std::is_same_v<Kind, Line>) entry.dashed = one.dashed;
            entry.dot = std::is_same_v<Kind, Scatter> || std::is_same_v<Kind, Intervals>;
            entry.interval = std::is_same_v<Kind, Intervals>;
            entry.area = std::is_same_v<Kind, Band> || std::is_same_v<Kind, Bars> || std::is_same_v<Kind, Boxes>;
            entries.push_back(std::move(entry));
          }
        },
        mark);
  return entries;
}

double width_of(const LegendEntry& entry) { return kSample + 4.0 + kLetter * letters(entry.label) + 12.0; }

std::string text_at(double x, double y, std::string_view css_class, std::string_view anchor, const std::string& text) {
  std::string svg = "<text class=\"";
  svg.append(css_class).append("\" x=\"").append(pixel(x)).append("\" y=\"").append(pixel(y));
  return svg.append("\" text-anchor=\"").append(anchor).append("\">").append(escaped(text)).append("</text>\n");
}

std::string sample_dot(const LegendEntry& entry, double x, double baseline) {
  std::string svg = "<circle class=\"";
  svg.append(ink_class(entry.ink)).append(" fill\" cx=\"").append(pixel(x + 0.5 * kSample));
  return svg.append("\" cy=\"").append(pixel(baseline - 4.0)).append("\" r=\"2.5\"/>\n");
}

/// A dot on its interval.
std::string sample_interval(const LegendEntry& entry, double x, double baseline) {
  const std::string middle = pixel(x + 0.5 * kSample);
  std::string svg = "<line class=\"";
  svg.append(ink_class(entry.ink)).append(" stroke\" x1=\"").append(middle).append("\" x2=\"").append(middle);
  svg.append("\" y1=\"").append(pixel(baseline - 9.0)).append("\" y2=\"").append(pixel(baseline + 1.0));
  return svg.append("\"/>\n").append(sample_dot(entry, x, baseline));
}

std::string sample_line(const LegendEntry& entry, double x, double baseline) {
  std::string svg = "<line class=\"";
  svg.append(ink_class(entry.ink)).append(" stroke\" x1=\"").append(pixel(x));
  svg.append("\" x2=\"").append(pixel(x + kSample)).append("\" y1=\"").append(pixel(baseline - 4.0));
  svg.append("\" y2=\"").append(pixel(baseline - 4.0)).append("\" stroke-width=\"");
  svg.append(entry.area ? "8\" stroke-opacity=\".35\"" : "2\"");
  return svg.append(entry.dashed ? " stroke-dasharray=\"5 3\"/>\n" : "/>\n");
}

/// Rows of the legend, right-aligned; returns the height that they take.
double draw_legend(const std::vector<LegendEntry>& entries, double first_baseline, double width, std::string& svg) {
  std::size_t begin = 0;
  double baseline = first_baseline;
  while (begin < entries.size()) {
    double row = 0.0;
    std::size_t end = begin;
    while (end < entries.size() && (end == begin || row + width_of(entries[end]) <= width - kLeft))
      row += width_of(entries[end++]);
    double x = width - kRight - row + 12.0;
    for (; begin < end; ++begin) {
      const LegendEntry& entry = entries[begin];
      svg += entry.interval ? sample_interval(entry, x, baseline)
             : entry.dot    ? sample_dot(entry, x, baseline)
                            : sample_line(entry, x, baseline);
      svg += text_at(x + kSample + 4.0, baseline, "tick", "start", entry.label);
      x += width_of(entry);
    }
    baseline += 15.0;
  }
  return baseline - first_baseline;
}

std::string axis_title(const std::string& words, const Scale& scale) {
  if (scale.unit.text.empty()) return words;
  return words.empty() ? scale.unit.text : std::string(words).append(", ").append(scale.unit.text);
}

void draw_axes(const Plot& plot, const Frame& frame, const Scale& x, const Scale& y, std::string& svg) {
  const int about_x = std::max(static_cast<int>(frame.width / 70.0), 2);
  const int about_y = std::max(static_cast<int>(frame.height / 34.0), 2);
  for (const Tick& tick : ticks_of(y, plot.y, about_y)) {
    const std::string at = pixel(frame.top + tick.pixel);
    svg.append("<line class=\"grid\" x1=\"").append(pixel(frame.left)).append("\" x2=\"");
    svg.append(pixel(frame.left + frame.width))
        .append("\" y1=\"")
        .append(at)
        .append("\" y2=\"")
        .append(at)
        .append("\"/>\n");
    if (plot.y.tick_labels) svg += text_at(frame.left - 5.0, frame.top + tick.pixel + 4.0, "tick", "end", tick.label);
  }
  for (const Tick& tick : ticks_of(x, plot.x, about_x)) {
    const std::string at = pixel(frame.left + tick.pixel);
    if (plot.x.categories.empty()) {
      svg.append("<line class=\"grid\" x1=\"").append(at).append("\" x2=\"").append(at).append("\" y1=\"");
      svg.append(pixel(frame.top)).append("\" y2=\"").append(pixel(frame.top + frame.height)).append("\"/>\n");
    }
    if (plot.x.tick_labels)
      svg += text_at(frame.left + tick.pixel, frame.top + frame.height + 14.0, "tick", "middle", tick.label);
  }
  const std::string label = axis_title(plot.x.label, x);
  if (plot.x.tick_labels && !label.empty())
    svg += text_at(frame.left + frame.width / 2.0, frame.top + frame.height + 28.0, "tick", "middle", label);
}

std::string opening(const Plot& plot, const std::string& title) {
  const std::string width = std::to_string(plot.width);
  const std::string height = std::to_string(plot.height);
  return std::string("<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" width=\"")
      .append(width)
      .append("\" height=\"")
      .append(height)
      .append("\" viewBox=\"0 0 ")
      .append(width)
      .append(" ")
      .append(height)
      .append("\">\n<title>")
      .append(escaped(title))
      .append("</title>\n");
}

/// Everything inside the frame: an inner svg, which cuts off what reaches beyond.
void draw_inside(const Plot& plot, const Frame& frame, const Scale& x, const Scale& y, std::string& svg) {
  const std::string place = std::string("x=\"")
                                .append(pixel(frame.left))
                                .append("\" y=\"")
                                .append(pixel(frame.top))
                                .append("\" width=\"")
                                .append(pixel(frame.width))
                                .append("\" height=\"")
                                .append(pixel(frame.height))
                                .append("\"");
  svg.append("<svg ").append(place).append(">\n").append(svg_of_marks(plot, x, y)).append("</svg>\n");
  svg.append("<rect class=\"frame\" ").append(place).append("/>\n");
}

}  // namespace

std::string ink_class(Ink ink) {
  switch (ink) {
    case Ink::foreground:
      return "ink-foreground";
    case Ink::muted:
      return "ink-muted";
    case Ink::first:
      return "ink-first";
    case Ink::second:
      return "ink-second";
    case Ink::third:
      return "ink-third";
    case Ink::fourth:
      return "ink-fourth";
    case Ink::bad:
      return "ink-bad";
  }
  return "ink-foreground";
}

std::string to_svg(const Plot& plot) {
  Scale x = scale_of_x(plot);
  Scale y = scale_of_y(plot);
  const std::string title = axis_title(plot.title.empty() ? plot.y.label : plot.title, y);
  std::string svg = opening(plot, title.empty() ? "plot" : title);

  const std::vector<LegendEntry> legend = legend_of(plot);
  double legend_width = 0.0;
  for (const LegendEntry& entry : legend) legend_width += width_of(entry);
  const double title_width = title.empty() ? 0.0 : kLeft + kLetter * 1.1 * letters(title);
  const bool one_row = title_width + legend_width <= plot.width - kRight;
  double top = title.empty() && legend.empty() ? 6.0 : 19.0;
  if (!title.empty()) svg += text_at(kLeft, 12.0, "title", "start", title);
  if (!legend.empty()) {
    const double first = one_row || title.empty() ? 12.0 : 27.0;
    top = first + draw_legend(legend, first, plot.width, svg) - 8.0;
  }
  const double bottom = !plot.x.tick_labels ? 5.0 : plot.x.label.empty() && x.unit.text.empty() ? 20.0 : 34.0;
  const Frame frame{.left = kLeft,
                    .top = top,
                    .width = plot.width - kLeft - kRight,
                    .height = std::max(plot.height - top - bottom, 10.0)};
  x.to = frame.width;
  y.from = frame.height;
  y.to = 0.0;
  if (x.empty || y.empty) {
    svg += text_at(frame.left + frame.width / 2.0, frame.top + frame.height / 2.0, "tick", "middle", "no data");
    svg.append("</svg>\n");
    return svg;
  }
  draw_axes(plot, frame, x, y, svg);
  draw_inside(plot, frame, x, y, svg);
  return svg.append("</svg>\n");
}

std::pair<std::vector<double>, std::vector<double>> thinned(const std::vector<double>& x, const std::vector<double>& y,
                                                            std::size_t columns) {
  const std::size_t size = std::min(x.size(), y.size());
  std::vector<double> across, up;
  const auto keep = [&](std::size_t k) {
    across.push_back(x[k]);
    up.push_back(y[k]);
  };
  if (columns == 0 || size <= 2 * columns || !(x[size - 1] > x[0])) {
    for (std::size_t k = 0; k < size; ++k) keep(k);
    return {std::move(across), std::move(up)};
  }
  const double per_column = static_cast<double>(columns) / (x[size - 1] - x[0]);
  std::size_t begin = 0;
  while (begin < size) {
    if (!std::isfinite(y[begin])) {  // a gap is kept, once
      if (up.empty() || std::isfinite(up.back())) keep(begin);
      ++begin;
      continue;
    }
    const double column = std::floor((x[begin] - x[0]) * per_column);
    std::size_t lowest = begin;
    std::size_t highest = begin;
    std::size_t end = begin;
    for (; end < size && std::isfinite(y[end]) && std::floor((x[end] - x[0]) * per_column) == column; ++end) {
      if (y[end] < y[lowest]) lowest = end;
      if (y[end] > y[highest]) highest = end;
    }
    keep(std::min(lowest, highest));
    if (lowest != highest) keep(std::max(lowest, highest));
    begin = std::max(end, begin + 1);
  }
  return {std::move(across), std::move(up)};
}

}  // namespace sealwatch::report
