// From data to pixels: the extent of a plot's marks, scales, ticks and their labels. Internal to plot.
#pragma once

#include <string>
#include <vector>

#include "services/common/report/plot.hpp"
#include "services/common/text/readable.hpp"

namespace sealwatch::report {

/// pixel = from + (place(si) - low) / (high - low) * (to - from), place(si) = si * factor or log10(si * factor).
struct Scale {
  text::DisplayUnit unit;
  double low = 0.0, high = 1.0;  ///< shown unit; logarithms on a logarithmic axis
  double from = 0.0, to = 1.0;   ///< pixels
  bool logarithmic = false;
  bool empty = true;  ///< no finite value

  /// NaN for what the axis cannot show.
  [[nodiscard]] double operator()(double si) const;
};

struct Tick {
  double pixel = 0.0;
  std::string label;
};

/// Scales of both axes without pixels (from, to), wide enough for all marks.
[[nodiscard]] Scale scale_of_x(const Plot& plot);
[[nodiscard]] Scale scale_of_y(const Plot& plot);

/// `about` ticks of a scale with its pixels.
[[nodiscard]] std::vector<Tick> ticks_of(const Scale& scale, const Axis& axis, int about);

/// Marks as SVG elements, in pixels of the scales.
[[nodiscard]] std::string svg_of_marks(const Plot& plot, const Scale& x, const Scale& y);

/// A pixel with one decimal.
[[nodiscard]] std::string pixel(double value);

}  // namespace sealwatch::report
