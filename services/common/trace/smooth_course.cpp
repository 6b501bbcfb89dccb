#include "sealwatch/trace/smooth_course.hpp"

#include <algorithm>
#include <cmath>

#include "sealwatch/signal/noise_floor.hpp"

namespace sealwatch::trace {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

/// At x of the way from one sample to the next the course is least known in the middle.
double share_between(double x) { return 16.0 * x * x * (1.0 - x) * (1.0 - x); }
constexpr double kMeanShare = 8.0 / 15.0;

}  // namespace

Course::Course(std::vector<double> time_s, std::vector<double> values)
    : time_s_(std::move(time_s)), values_(std::move(values)), slopes_(values_.size()) {
  const std::size_t last = values_.size() - 1;
  for (std::size_t k = 0; k <= last; ++k) {
    const std::size_t before = k == 0 ? 0 : k - 1, after = std::min(k + 1, last);
    slopes_[k] = (values_[after] - values_[before]) / (time_s_[after] - time_s_[before]);
  }
  for (std::size_t k = 0; k <= last; ++k) missed_.push_back(missed_at(k));
}

std::pair<double, double> Course::cubic(std::size_t from, std::size_t to, double from_slope, double to_slope,
                                        double time_s) const {
  const double h = time_s_[to] - time_s_[from], x = (time_s - time_s_[from]) / h;
  const double y0 = values_[from], y1 = values_[to], m0 = from_slope * h, m1 = to_slope * h;
  const double a = 2.0 * (y0 - y1) + m0 + m1, b = 3.0 * (y1 - y0) - 2.0 * m0 - m1;
  return {((a * x + b) * x + m0) * x + y0, ((3.0 * a * x + 2.0 * b) * x + m0) / h};
}

double Course::missed_at(std::size_t sample) const {
  const std::size_t last = values_.size() - 1;
  if (sample == 0 || sample == last) return 0.0;
  const std::size_t from = sample - 1, to = sample + 1;
  const auto slope = [&](std::size_t a, std::size_t b) {
    return (values_[b] - values_[a]) / (time_s_[b] - time_s_[a]);
  };
  const double before = slope(from < 2 ? from : from - 2, to), after = slope(from, to + 2 > last ? to : to + 2);
  return values_[sample] - cubic(from, to, before, after, time_s_[sample]).first;
}

std::size_t Course::interval_of(double time_s) const {
  // Sampling is nearly uniform: the place is guessed, and looked for where the guess is wrong.
  const double share = (time_s - time_s_.front()) / (time_s_.back() - time_s_.front());
  const auto k =
      std::min(static_cast<std::size_t>(share * static_cast<double>(time_s_.size() - 1)), time_s_.size() - 2);
  if (time_s >= time_s_[k] && time_s < time_s_[k + 1]) return k;
  return static_cast<std::size_t>(std::ranges::upper_bound(time_s_, time_s) - time_s_.begin()) - 1;
}

double Course::missed_in(std::size_t interval) const {
  return std::max(std::abs(missed_[interval]), std::abs(missed_[interval + 1]));
}

double Course::variance_at(double time_s) const {
  if (time_s <= time_s_.front() || time_s >= time_s_.back()) return 0.0;
  const std::size_t k = interval_of(time_s);
  const double x = (time_s - time_s_[k]) / (time_s_[k + 1] - time_s_[k]);
  return share_between(x) * missed_in(k) * missed_in(k);
}

double Course::mean_variance() const {
  double sum = 0.0;
  for (std::size_t k = 0; k + 1 < time_s_.size(); ++k)
    sum += missed_in(k) * missed_in(k) * (time_s_[k + 1] - time_s_[k]);
  return kMeanShare * sum / (time_s_.back() - time_s_.front());
}

std::pair<double, double> Course::at(double time_s) const {
  if (time_s <= time_s_.front()) return {values_.front(), 0.0};
  if (time_s >= time_s_.back()) return {values_.back(), 0.0};
  const std::size_t k = interval_of(time_s);
  return cubic(k, k + 1, slopes_[k], slopes_[k + 1], time_s);
}

namespace {

/// Of the lines through windows, at each sample.
struct Lines {
  VectorXd values, slopes, beside;
};

/// Sums over windows of a course, each built from two of half its length: as much work for wide windows as for narrow.
class WindowSums {
 public:
  explicit WindowSums(VectorXd values) : values_(std::move(values)), sums_(values_), moments_(VectorXd::Zero(size())) {}

  [[nodiscard]] Index size() const { return values_.size(); }

  void double_length() {
    for (Index t = 0; t + 2 * length_ <= size(); ++t) {
      moments_(t) += moments_(t + length_) + static_cast<double>(length_) * sums_(t + length_);
      sums_(t) += sums_(t + length_);
    }
    length_ *= 2;
  }

  /// Per sample, of the line through `length` + 1 samples about each; through those that there are near to the ends.
  [[nodiscard]] Lines lines() const {
    const Index half = length_ / 2, last = size() - 1;
    Lines out{VectorXd(size()), VectorXd(size()), VectorXd(size())};
    const auto set = [&](Index at, double way, const Line& line) {
      out.slopes(at) = way * line.slope, out.values(at) = line.value, out.beside(at) = line.beside;
    };
    for (Index t = half; t + half <= last; ++t) {
      const double end = values_(t + half), sum = sums_(t - half) + end;
      const double moment = moments_(t - half) + static_cast<double>(length_) * end;
      set(t, 1.0, line(length_ + 1, half, sum, moment, values_(t)));
    }
    at_an_end(
        half, [&](Index k) { return k; }, [&](Index k, const Line& line) { set(k, 1.0, line); });
    at_an_end(
        half, [&](Index k) { return last - k; }, [&](Index k, const Line& line) { set(last - k, -1.0, line); });
    return out;
  }

  /// Sum of the squared distances from their middle of so many samples.
  [[nodiscard]] static double squares(Index count) {
    const auto n = static_cast<double>(count);
    return n * (n * n - 1.0) / 12.0;
  }

 private:
  struct Line {
    double value, slope, beside;
  };

  /// Through `count` samples, of their sum and moment about the first, at sample `at`, which is `own`.
  [[nodiscard]] static Line line(Index count, Index at, double sum, double moment, double own) {
    const double n = static_cast<double>(count), middle = 0.5 * (n - 1.0);
    const double slope = (moment - middle * sum) / squares(count);
    return {sum / n + slope * (static_cast<double>(at) - middle), slope, (sum - own) / (n - 1.0)};
  }

  template <class Place, class Set>
  void at_an_end(Index half, const Place& place, const Set& set) const {
    double sum = 0.0, moment = 0.0;
    Index count = 0;
    for (Index k = 0; k < std::min(half, size()); ++k) {
      for (; count <= std::min(k + half, size() - 1); ++count)
        sum += values_(place(count)), moment += static_cast<double>(count) * values_(place(count));
      set(k, line(count, k, sum, moment, values_(place(k))));
    }
  }

  VectorXd values_;
  VectorXd sums_;     ///< of the `length_` values from each on
  VectorXd moments_;  ///< the same, each times its distance from the first
  Index length_ = 1;
};

}  // namespace

SmoothCourse smooth_course(const VectorXd& values, double interval_s) {
  constexpr double kNoiseShare = 0.1;
  const double noise =
      signal::estimate_noise_floor({values.data(), static_cast<std::size_t>(values.size())}).standard_deviation;
  const Index n = values.size();
  const double mean = values.mean();
  WindowSums sums(values.array() - mean);
  for (Index k = 1;; k *= 2) {
    sums.double_length();
    Lines lines = sums.lines();
    lines.slopes /= interval_s;
    const double noise_at_the_ends = noise / std::sqrt(WindowSums::squares(k + 1)) / interval_s;
    const double rms = std::sqrt(lines.slopes.squaredNorm() / static_cast<double>(n));
    if (noise_at_the_ends > kNoiseShare * rms && k <= n / 50) continue;
    return {.half_window = k,
            .values = k == 1 ? values : VectorXd(lines.values.array() + mean),
            .slope = std::move(lines.slopes),
            .beside = lines.beside.array() + mean};
  }
}

VectorXd SmoothCourse::curvature(double interval_s) const {
  const Index last = slope.size() - 1, reach = half_window + 1;
  VectorXd out(slope.size());
  for (Index t = 0; t <= last; ++t) {
    const Index from = std::max<Index>(t - reach, 0), to = std::min(t + reach, last);
    out(t) = (slope(to) - slope(from)) / (static_cast<double>(to - from) * interval_s);
  }
  return out;
}

}  // namespace sealwatch::trace
