// A sensor's first-order low-pass tau dy/dt = s - y, exact for a signal s that is linear between the points at which it
// is known:
//
//   y_1 = a y_0 + (g - a) s_0 + (1 - g) s_1,   a = exp(-h / tau),  g = (1 - a) tau / h
//
// It is linear, so sensitivities of s pass through the same filter. At the first point y = s.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace sealwatch {

class SensorFilter {
 public:
  SensorFilter(double time_constant_s, std::size_t columns)
      : time_constant_s_(time_constant_s), signal_(columns, 0.0), output_(columns, 0.0) {}

  /// Next point of all columns, `step_s` after the last one.
  void advance(double step_s, const double* signal) {
    if (!started_ || time_constant_s_ <= 0.0) {
      std::copy(signal, signal + output_.size(), output_.begin());
      started_ = true;
    } else if (step_s > 0.0) {  // a signal that jumps moves the output later
      set_step(step_s);
      for (std::size_t j = 0; j < output_.size(); ++j)
        output_[j] = decay_ * output_[j] + (mean_ - decay_) * signal_[j] + (1.0 - mean_) * signal[j];
    }
    std::copy(signal, signal + signal_.size(), signal_.begin());
  }

  [[nodiscard]] const std::vector<double>& output() const { return output_; }

 private:
  void set_step(double step_s) {
    if (std::abs(step_s - step_s_) < 1e-12) return;
    step_s_ = step_s;
    decay_ = std::exp(-step_s / time_constant_s_);
    mean_ = -std::expm1(-step_s / time_constant_s_) * time_constant_s_ / step_s;
  }

  double time_constant_s_;
  double step_s_ = -1.0, decay_ = 0.0, mean_ = 0.0;
  bool started_ = false;
  std::vector<double> signal_, output_;
};

}  // namespace sealwatch
