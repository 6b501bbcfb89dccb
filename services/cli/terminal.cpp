#include "services/cli/terminal.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "sealwatch/core/time.hpp"
#include "services/common/text/format.hpp"

namespace sealwatch::cli {

std::string date(std::int64_t time_ns) { return format_date(UtcTime{time_ns}); }

std::string to_the_second(UtcTime time) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  return format_utc({time.nanoseconds - time.nanoseconds % kSecond_ns});
}

std::string bar(double share, std::size_t cells) {
  constexpr double kNothing = 0.0005;  // shown as 0.0 %
  if (!(share > 0.0)) share = 0.0;
  const auto marks = static_cast<std::size_t>(std::lround(std::min(share, 1.0) * static_cast<double>(cells)));
  const std::string filled = marks == 0 && share >= kNothing ? "." : std::string(marks, '#');
  return padded(std::string("|").append(filled), cells + 1).append("|");
}

void Progress::show(std::size_t done, std::string_view remark) {
  done = std::min(done, total_);  // services may conclude from tests of before, too: never "2 of 1"
  const std::size_t tenth = total_ == 0 ? 10 : 10 * done / total_;
  const std::string state = std::to_string(done)
                                .append(thing_ == "%" ? " %" : " of " + std::to_string(total_) + " " + thing_)
                                .append(remark.empty() ? "" : ", ")
                                .append(remark);
  if (isatty(STDERR_FILENO) != 0) {
    constexpr int kBar = 24;
    const int filled = total_ == 0 ? kBar : static_cast<int>(kBar * done / total_);
    std::fprintf(stderr, "\r\033[K%s [%s%s] %s", what_.c_str(),
                 std::string(static_cast<std::size_t>(filled), '#').c_str(),
                 std::string(static_cast<std::size_t>(kBar - filled), '.').c_str(), state.c_str());
    std::fflush(stderr);
    drawn_ = true;
  } else if (tenth > last_tenth_) {
    std::fprintf(stderr, "%s: %s\n", what_.c_str(), state.c_str());
    last_tenth_ = tenth;
  }
}

void Progress::clear() {
  if (!drawn_) return;
  std::fprintf(stderr, "\r\033[K");
  std::fflush(stderr);
  drawn_ = false;
}

void Progress::finish() { clear(); }

namespace {

/// Cell of a coordinate between low and high in `cells` cells, clamped.
int cell(double value, double low, double high, int cells) {
  const double share = high > low ? (value - low) / (high - low) : 0.0;
  return std::clamp(static_cast<int>(std::lround(share * (cells - 1))), 0, cells - 1);
}

}  // namespace

std::string chart(const std::vector<ChartPoint>& points, const ChartOptions& options) {
  if (points.empty()) return {};
  double x_low = points.front().x;
  double x_high = points.front().x;
  for (const ChartPoint& point : points) {
    x_low = std::min(x_low, point.x);
    x_high = std::max(x_high, point.x);
  }
  std::vector<std::string> rows(static_cast<std::size_t>(options.height),
                                std::string(static_cast<std::size_t>(options.width), ' '));
  int threshold_row = -1;
  if (options.threshold)
    threshold_row = options.height - 1 - cell(*options.threshold, options.y_low, options.y_high, options.height);
  for (int column = 0; threshold_row >= 0 && column < options.width; column += 2)
    rows[static_cast<std::size_t>(threshold_row)][static_cast<std::size_t>(column)] = '-';
  for (const ChartPoint& point : points) {
    const int row = options.height - 1 - cell(point.y, options.y_low, options.y_high, options.height);
    rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(cell(point.x, x_low, x_high, options.width))] = 'o';
  }
  std::string text;
  for (int row = 0; row < options.height; ++row) {
    const double y = options.y_high - (options.y_high - options.y_low) * row / (options.height - 1);
    text += text::format("{:6.1f} |{}", y, rows[static_cast<std::size_t>(row)]);
    if (row == threshold_row) text.append("  ").append(options.threshold_label);
    text += '\n';
  }
  const int gap = options.width - static_cast<int>(options.x_low_label.size() + options.x_high_label.size());
  return text + "       +" + std::string(static_cast<std::size_t>(options.width), '-') + "\n        " +
         options.x_low_label + std::string(static_cast<std::size_t>(std::max(gap, 1)), ' ') + options.x_high_label +
         "\n";
}

}  // namespace sealwatch::cli
