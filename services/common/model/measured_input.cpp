#include "services/common/model/measured_input.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <Eigen/Dense>

#include "sealwatch/signal/noise_floor.hpp"

namespace sealwatch {
namespace {

struct LocalFit {
  double value = 0.0, slope = 0.0;
};

// Least squares a + b k + c k^2 over k = -m..m; sums of even powers of k in closed form.
LocalFit parabola(const std::vector<double>& values, std::size_t at, std::ptrdiff_t m) {
  const double n = 2.0 * static_cast<double>(m) + 1.0;
  double s2 = 0.0, s4 = 0.0, y0 = 0.0, y1 = 0.0, y2 = 0.0;
  for (std::ptrdiff_t k = -m; k <= m; ++k) {
    const double d = static_cast<double>(k), y = values[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(at) + k)];
    s2 += d * d;
    s4 += d * d * d * d;
    y0 += y;
    y1 += d * y;
    y2 += d * d * y;
  }
  if (m < 2) return {.value = values[at], .slope = m == 0 ? 0.0 : y1 / s2};
  return {.value = (s4 * y0 - s2 * y2) / (n * s4 - s2 * s2), .slope = y1 / s2};
}

}  // namespace

SmoothedInput smoothed_input(const std::vector<double>& time_s, const std::vector<double>& values, double reach_s) {
  const std::size_t count = values.size();
  SmoothedInput smoothed{.values = values, .slopes = std::vector<double>(count, 0.0)};
  if (count < 3) return smoothed;
  const double step_s = (time_s.back() - time_s.front()) / static_cast<double>(count - 1);
  const auto reach = static_cast<std::ptrdiff_t>(std::lround(reach_s / step_s));
  for (std::size_t k = 0; k < count; ++k) {
    const auto m = std::min({reach, static_cast<std::ptrdiff_t>(k), static_cast<std::ptrdiff_t>(count - 1 - k)});
    const LocalFit local = parabola(values, k, m);
    smoothed.values[k] = local.value;
    smoothed.slopes[k] = local.slope / step_s;
  }
  return smoothed;
}

// Continuous curvature at every sample: a tridiagonal system, solved by elimination.
std::vector<double> spline_slopes(const std::vector<double>& time_s, const std::vector<double>& values) {
  const std::size_t last = values.size() - 1;
  std::vector<double> diagonal(last + 1), right(last + 1), beyond(last + 1, 0.0);
  const auto step = [&](std::size_t k) { return time_s[k + 1] - time_s[k]; };
  const auto secant = [&](std::size_t k) { return (values[k + 1] - values[k]) / step(k); };
  diagonal[0] = 2.0, beyond[0] = 1.0, right[0] = 3.0 * secant(0);
  for (std::size_t k = 1; k <= last; ++k) {
    const bool end = k == last;
    const double before = end ? 1.0 : 1.0 / step(k - 1), after = end ? 0.0 : 1.0 / step(k);
    diagonal[k] = 2.0 * (before + after);
    beyond[k] = after;
    right[k] = 3.0 * (before * secant(k - 1) + (end ? 0.0 : after * secant(k)));
    const double factor = before / diagonal[k - 1];
    diagonal[k] -= factor * beyond[k - 1];
    right[k] -= factor * right[k - 1];
  }
  std::vector<double> slopes(last + 1);
  for (std::size_t k = last + 1; k-- > 0;)
    slopes[k] = (right[k] - (k == last ? 0.0 : beyond[k] * slopes[k + 1])) / diagonal[k];
  return slopes;
}

std::vector<double> means_of_neighbours(const std::vector<double>& held) {
  std::vector<double> means = held;
  for (std::size_t row = 1; row < held.size(); ++row) means[row] = 0.5 * (held[row - 1] + held[row]);
  return means;
}

namespace {

constexpr double kReach_s = 0.16;
constexpr double kStandardErrors = 1.8;

struct Estimate {
  double value = 0.0, std_error = 0.0;
};

// u at a sample by least squares over its neighbours `from` to `to`.
Estimate undone(const std::vector<double>& time_s, const std::vector<double>& values, std::size_t at, std::size_t from,
                std::size_t to, double time_constant_s, double noise_std) {
  const double step_s = (time_s[to] - time_s[from]) / static_cast<double>(to - from), lag = time_constant_s / step_s;
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t k = from; k <= to; ++k) {
    const double d = (time_s[k] - time_s[at]) / step_s;
    const Eigen::Vector3d powers(1.0, d, d * d);
    gram += powers * powers.transpose();
    right += values[k] * powers;
  }
  const Eigen::Vector3d by = gram.ldlt().solve(Eigen::Vector3d(1.0, lag, 0.0));
  return {.value = by.dot(right), .std_error = noise_std * std::sqrt(std::max(0.0, by(0) + lag * by(1)))};
}

}  // namespace

std::vector<double> undo_sensor(const std::vector<double>& time_s, const std::vector<double>& values,
                                double time_constant_s) {
  const std::size_t count = values.size();
  if (count < 3) return values;
  const double step_s = (time_s.back() - time_s.front()) / static_cast<double>(count - 1);
  const auto longest = std::max<std::size_t>(2, static_cast<std::size_t>(std::lround(kReach_s / step_s)));
  const double noise_std = signal::estimate_noise_floor(values, time_s).standard_deviation;
  std::vector<double> inputs(count);
  for (std::size_t k = 0; k < count; ++k) {
    double least = -std::numeric_limits<double>::infinity(), most = -least;
    for (std::size_t reach = 2; reach <= longest; reach = std::max(reach + 1, reach * 5 / 4)) {
      const Estimate estimate =
          undone(time_s, values, k, k - std::min(k, reach), std::min(count - 1, k + reach), time_constant_s, noise_std);
      least = std::max(least, estimate.value - kStandardErrors * estimate.std_error);
      most = std::min(most, estimate.value + kStandardErrors * estimate.std_error);
      if (least > most) break;
      inputs[k] = estimate.value;
    }
  }
  return inputs;
}

}  // namespace sealwatch
