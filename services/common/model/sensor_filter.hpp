// A sensor's first-order low-pass tau dy/dt = s - y, exact for a signal s that is a parabola through the point, the one
// before and the one before that:
//
//   y_1 = a y_0 + (g - a) s_0 + (1 - g) s_1 + q c,   a = exp(-x),  g = (1 - a) / x,  x = h / tau
//   q = -tau^2 (x - 2 + a (x + 2)),   c = ((s_1 - s_0) / h - (s_0 - s_-1) / h_0) / (h + h_0)
//
// with h to the point before, h_0 from that to the one before; q c is 0 at the second point and behind a jump of s. It
// is linear, so sensitivities of s pass through the same filter. At the first point y = s.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace sealwatch {

class SensorFilter {
 public:
  SensorFilter(double time_constant_s, std::size_t columns)
      : time_constant_s_(time_constant_s), earlier_(columns, 0.0), signal_(columns, 0.0), output_(columns, 0.0) {}

  /// Next point of all columns, `step_s` after the last one.
  void advance(double step_s, const double* signal) {
    if (time_constant_s_ <= 0.0) {
      std::copy(signal, signal + output_.size(), output_.begin());
      return;
    }
    if (!started_) {
      std::copy(signal, signal + output_.size(), output_.begin());
      started_ = true;
    } else {
      if (step_s > 0.0) follow(step_s, signal);  // a signal that jumps moves the output later
      last_step_s_ = step_s;
      std::swap(earlier_, signal_);
    }
    std::copy(signal, signal + signal_.size(), signal_.begin());
  }

  [[nodiscard]] const std::vector<double>& output() const { return output_; }

 private:
  void follow(double step_s, const double* signal) {
    set_step(step_s);
    const double bend = last_step_s_ > 0.0 ? bend_ / (step_s + last_step_s_) : 0.0;
    const double of_earlier = bend == 0.0 ? 0.0 : bend / last_step_s_;
    const double now = 1.0 - mean_ + bend / step_s, before = mean_ - decay_ - bend / step_s - of_earlier;
    for (std::size_t j = 0; j < output_.size(); ++j)
      output_[j] = decay_ * output_[j] + before * signal_[j] + now * signal[j] + of_earlier * earlier_[j];
  }

  void set_step(double step_s) {
    if (std::abs(step_s - step_s_) < 1e-12) return;
    constexpr double kSmall = 0.01;  // below it the series, which is then exact to 1e-7 of q
    step_s_ = step_s;
    const double x = step_s / time_constant_s_;
    decay_ = std::exp(-x);
    mean_ = -std::expm1(-x) / x;
    const double share =
        x < kSmall ? x * x * x * (1.0 / 6.0 - x * (1.0 / 12.0 - x / 40.0)) : x - 2.0 + decay_ * (x + 2.0);
    bend_ = -time_constant_s_ * time_constant_s_ * share;
  }

  double time_constant_s_;
  double step_s_ = -1.0, last_step_s_ = 0.0;
  double decay_ = 0.0, mean_ = 0.0, bend_ = 0.0;  ///< a, g, q
  bool started_ = false;
  std::vector<double> earlier_, signal_, output_;
};

}  // namespace sealwatch
