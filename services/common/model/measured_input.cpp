#include "services/common/model/measured_input.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace sealwatch {
namespace {

constexpr double kReach_s = 0.04;

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

std::vector<double> undo_sensor(const std::vector<double>& time_s, const std::vector<double>& values,
                                double time_constant_s) {
  const std::size_t count = values.size();
  if (count < 3) return values;
  const double step_s = (time_s.back() - time_s.front()) / static_cast<double>(count - 1);
  const auto reach = static_cast<std::ptrdiff_t>(std::lround(kReach_s / step_s));
  std::vector<double> input(count);
  for (std::size_t k = 0; k < count; ++k) {
    const auto m = std::min({reach, static_cast<std::ptrdiff_t>(k), static_cast<std::ptrdiff_t>(count - 1 - k)});
    const LocalFit local = parabola(values, k, m);
    input[k] = local.value + time_constant_s * local.slope / step_s;
  }
  return input;
}

}  // namespace sealwatch
