#include "services/common/report/plot_scale.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/common/text/format.hpp"
#include "services/common/text/readable.hpp"

namespace sealwatch::report {
namespace {

/// Lowest and highest finite value seen.
struct Extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  bool logarithmic = false;

  void add(double value) {
    if (!std::isfinite(value) || (logarithmic && value <= 0.0)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  void add(const std::vector<double>& values) {
    for (const double value : values) add(value);
  }
  [[nodiscard]] bool empty() const { return low > high; }
};

struct ExtentOfX {
  Extent& extent;
  void operator()(const Line& line) const { extent.add(line.x); }
  void operator()(const Band& band) const { extent.add(band.x); }
  void operator()(const Scatter& points) const { extent.add(points.x); }
  void operator()(const Bars& bars) const { extent.add(bars.edges); }
  void operator()(const Intervals& intervals) const { extent.add(intervals.x); }
  void operator()(const Reference& reference) const {
    if (reference.vertical) extent.add(reference.at);
  }
  void operator()(const Boxes& boxes) const {
    for (const Box& box : boxes.boxes) {
      extent.add(box.x - boxes.width / 2.0);
      extent.add(box.x + boxes.width / 2.0);
    }
  }
};

struct ExtentOfY {
  Extent& extent;
  void operator()(const Line& line) const { extent.add(line.y); }
  void operator()(const Scatter& points) const { extent.add(points.y); }
  void operator()(const Band& band) const {
    extent.add(band.low);
    extent.add(band.high);
  }
  void operator()(const Bars& bars) const {
    extent.add(bars.heights);
    extent.add(0.0);
  }
  void operator()(const Intervals& intervals) const {
    extent.add(intervals.y);
    extent.add(intervals.low);
    extent.add(intervals.high);
  }
  void operator()(const Reference& reference) const {
    if (!reference.vertical) extent.add(reference.at);
  }
  void operator()(const Boxes& boxes) const {
    for (const Box& box : boxes.boxes) {
      extent.add(box.low);
      extent.add(box.high);
    }
  }
};

/// `margin`: share of the extent left free at either end.
Scale scale_of(const Axis& axis, Extent extent, double margin) {
  Scale scale{.unit = {}, .logarithmic = axis.logarithmic, .empty = extent.empty() && !axis.range};
  if (axis.range) {
    extent.low = axis.range->first;
    extent.high = axis.range->second;
    margin = 0.0;
  } else if (!axis.categories.empty()) {
    extent.add(-0.5);
    extent.add(static_cast<double>(axis.categories.size()) - 0.5);
    margin = 0.0;
  }
  if (scale.empty) return scale;
  const bool plain = axis.unit.empty() || axis.unit == "1" || !axis.categories.empty();
  if (!plain) scale.unit = text::display_unit(axis.unit, std::max(std::abs(extent.low), std::abs(extent.high)));
  const auto place = [&scale](double si) {
    return scale.logarithmic ? std::log10(si * scale.unit.factor) : si * scale.unit.factor;
  };
  scale.low = place(extent.low);
  scale.high = place(extent.high);
  const double size = std::max(std::abs(scale.low), std::abs(scale.high));
  if (!(scale.high - scale.low > 1e-12 * size)) {  // one value alone: around it
    const double half = scale.logarithmic || size == 0.0 ? 1.0 : 0.1 * size;
    scale.low -= half;
    scale.high += half;
  }
  const double free = margin * (scale.high - scale.low);
  scale.low -= free;
  scale.high += free;
  return scale;
}

std::string tick_label(double value, double step) {
  const double size = std::max(std::abs(value), step);
  if (size >= 1e6 || size < 1e-4) return value == 0.0 ? "0" : text::number_text(value, 2);
  const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 6);
  const std::string text = text::format("{:.{}f}", value == 0.0 ? 0.0 : value, decimals);
  return text.starts_with("-") ? std::string("−").append(text, 1) : text;
}

}  // namespace

double Scale::operator()(double si) const {
  const double shown = si * unit.factor;
  const double place = logarithmic ? (shown > 0.0 ? std::log10(shown) : std::nan("")) : shown;
  return from + (place - low) / (high - low) * (to - from);
}

Scale scale_of_x(const Plot& plot) {
  Extent extent{.logarithmic = plot.x.logarithmic};
  bool runs_through = false;  // lines reach the frame, points keep away from it
  for (const Mark& mark : plot.marks) {
    std::visit(ExtentOfX{extent}, mark);
    runs_through = runs_through || std::holds_alternative<Line>(mark) || std::holds_alternative<Band>(mark) ||
                   std::holds_alternative<Bars>(mark);
  }
  return scale_of(plot.x, extent, runs_through ? 0.0 : 0.04);
}

Scale scale_of_y(const Plot& plot) {
  Extent extent{.logarithmic = plot.y.logarithmic};
  for (const Mark& mark : plot.marks) std::visit(ExtentOfY{extent}, mark);
  return scale_of(plot.y, extent, 0.06);
}

std::vector<double> nice_ticks(double low, double high, int about) {
  std::vector<double> ticks;
  if (!(high > low) || about < 1 || !std::isfinite(high - low)) return ticks;
  const double raw = (high - low) / about;
  const double decade = std::pow(10.0, std::floor(std::log10(raw)));
  const double lead = raw / decade;
  const double step = decade * (lead < 1.5 ? 1.0 : lead < 3.5 ? 2.0 : lead < 7.5 ? 5.0 : 10.0);
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) ticks.push_back(k * step);
  return ticks;
}

std::vector<double> logarithmic_ticks(double low, double high) {
  std::vector<double> ticks;
  if (!(low > 0.0) || !(high > low) || !std::isfinite(high)) return ticks;
  const double first = std::floor(std::log10(low));
  const double last = std::floor(std::log10(high));
  const bool few = last - first < 3.0;
  const double every = std::max(std::ceil((last - first) / 8.0), 1.0);
  for (double exponent = first; exponent <= last; exponent += every)
    for (const double lead : {1.0, 2.0, 5.0}) {
      if (lead > 1.0 && !few) break;
      const double value = lead * std::pow(10.0, exponent);
      if (value >= low * (1.0 - 1e-9) && value <= high * (1.0 + 1e-9)) ticks.push_back(value);
    }
  return ticks;
}

std::vector<Tick> ticks_of(const Scale& scale, const Axis& axis, int about) {
  std::vector<Tick> ticks;
  const auto at = [&scale](double place) {
    return scale.from + (place - scale.low) / (scale.high - scale.low) * (scale.to - scale.from);
  };
  if (!axis.categories.empty()) {
    for (std::size_t k = 0; k < axis.categories.size(); ++k)
      ticks.push_back({at(static_cast<double>(k)), axis.categories[k]});
  } else if (scale.logarithmic) {
    for (const double value : logarithmic_ticks(std::pow(10.0, scale.low), std::pow(10.0, scale.high)))
      ticks.push_back({at(std::log10(value)), text::number_text(value, 1)});
  } else {
    if (axis.whole) about = std::min(about, std::max(1, static_cast<int>(scale.high - scale.low)));
    std::vector<double> values = nice_ticks(scale.low, scale.high, about);
    for (int more = about + 1; values.size() < 2 && more < 3 * about; ++more)  // one label says nothing of the scale
      values = nice_ticks(scale.low, scale.high, more);
    const double step = values.size() > 1 ? values[1] - values[0] : 1.0;
    for (const double value : values) ticks.push_back({at(value), tick_label(value, step)});
  }
  return ticks;
}

}  // namespace sealwatch::report
