// What the command line shows: numbers with units that people can read, progress on standard error, small charts.
#pragma once

#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sealwatch/core/time.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::cli {

using text::count_of;
using text::joined;
using text::letters;
using text::padded;
using text::percent;
using text::wrapped;

/// As columns show it.
[[nodiscard]] inline std::string number(double value, int digits = 4) { return text::with_zeros(value, digits); }
/// Date of a UTC time in nanoseconds, "2031-04-12".
[[nodiscard]] std::string date(std::int64_t time_ns);

/// UTC to the second, for a person: "2031-04-12T03:00:00Z".
[[nodiscard]] std::string to_the_second(UtcTime time);

/// "|#####               |": a share of one, cut to 0 .. 1. What is too little for a whole mark, but not nothing, is a
/// dot.
[[nodiscard]] std::string bar(double share, std::size_t cells = 20);

/// One line on standard error that is overwritten, when that is a terminal; otherwise a line every ten percent:
/// "replay: 11 of 106 tests, 2010-02-23". Of `thing` "%", `total` is 100: "fit: 17 %, iteration 2".
class Progress {
 public:
  Progress(std::string what, std::size_t total, std::string thing)
      : what_(std::move(what)), total_(total), thing_(std::move(thing)) {}
  ~Progress() { finish(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void show(std::size_t done, std::string_view remark = {});
  /// Clears the line so that other output can follow; the next show() draws it again.
  void clear();
  void finish();

 private:
  std::string what_;
  std::size_t total_;
  std::string thing_;
  std::size_t last_tenth_ = 0;
  bool drawn_ = false;
};

/// One point of a chart; `error` is one standard deviation (0: none).
struct ChartPoint {
  double x = 0.0;
  double y = 0.0;
};

struct ChartOptions {
  int width = 64;
  int height = 10;
  double y_low = 0.0;
  double y_high = 1.0;
  std::optional<double> threshold;  ///< a dashed line across
  std::string threshold_label;
  std::string x_low_label;
  std::string x_high_label;
};

/// A chart of points in characters, a label on each axis end.
[[nodiscard]] std::string chart(const std::vector<ChartPoint>& points, const ChartOptions& options);

}  // namespace sealwatch::cli
