#include "sealwatch/trace/smooth_course.hpp"

#include <algorithm>
#include <cmath>

#include "sealwatch/signal/noise_floor.hpp"

namespace sealwatch::trace {

using Eigen::Index;
using Eigen::VectorXd;

Course::Course(std::vector<double> time_s, std::vector<double> values)
    : time_s_(std::move(time_s)), values_(std::move(values)), slopes_(values_.size()) {
  const std::size_t last = values_.size() - 1;
  for (std::size_t k = 0; k <= last; ++k) {
    const std::size_t before = k == 0 ? 0 : k - 1, after = std::min(k + 1, last);
    slopes_[k] = (values_[after] - values_[before]) / (time_s_[after] - time_s_[before]);
  }
}

std::pair<double, double> Course::at(double time_s) const {
  if (time_s <= time_s_.front()) return {values_.front(), 0.0};
  if (time_s >= time_s_.back()) return {values_.back(), 0.0};
  // Sampling is nearly uniform: the place is guessed, and looked for where the guess is wrong.
  const double share = (time_s - time_s_.front()) / (time_s_.back() - time_s_.front());
  auto k = std::min(static_cast<std::size_t>(share * static_cast<double>(time_s_.size() - 1)), time_s_.size() - 2);
  if (time_s < time_s_[k] || time_s >= time_s_[k + 1])
    k = static_cast<std::size_t>(std::ranges::upper_bound(time_s_, time_s) - time_s_.begin()) - 1;
  const double h = time_s_[k + 1] - time_s_[k], x = (time_s - time_s_[k]) / h;
  const double y0 = values_[k], y1 = values_[k + 1], m0 = slopes_[k] * h, m1 = slopes_[k + 1] * h;
  const double a = 2.0 * (y0 - y1) + m0 + m1, b = 3.0 * (y1 - y0) - 2.0 * m0 - m1;
  return {((a * x + b) * x + m0) * x + y0, ((3.0 * a * x + 2.0 * b) * x + m0) / h};
}

VectorXd smooth_slope(const VectorXd& values, double interval_s) {
  constexpr double kNoiseShare = 0.1;
  const double noise =
      signal::estimate_noise_floor({values.data(), static_cast<std::size_t>(values.size())}).standard_deviation;
  const Index n = values.size();
  VectorXd slope(n);
  for (Index k = 1;; k *= 2) {
    // Least-squares line through 2k + 1 samples; nearer to the ends through as many as there are to either side.
    double noise_of_slope = 0.0;
    for (Index t = 0; t < n; ++t) {
      const Index low = std::max<Index>(t - k, 0), high = std::min(t + k, n - 1);
      const double middle = 0.5 * static_cast<double>(low + high);
      double product = 0.0, squares = 0.0;
      for (Index i = low; i <= high; ++i) {
        const double x = static_cast<double>(i) - middle;
        product += x * values(i), squares += x * x;
      }
      slope(t) = product / squares / interval_s;
      noise_of_slope = noise / std::sqrt(squares) / interval_s;
    }
    const double rms = std::sqrt(slope.squaredNorm() / static_cast<double>(n));
    if (noise_of_slope <= kNoiseShare * rms || k > n / 50) return slope;
  }
}

}  // namespace sealwatch::trace
