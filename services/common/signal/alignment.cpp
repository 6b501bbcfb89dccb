#include "sealwatch/signal/alignment.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "sealwatch/signal/statistics.hpp"

namespace sealwatch::signal {
namespace {

/// Four sums side by side: one alone would wait for itself at every term.
double dot(const double* a, const double* b, std::size_t count) {
  double sums[4] = {};
  std::size_t i = 0;
  for (; i + 4 <= count; i += 4)
    for (std::size_t k = 0; k < 4; ++k) sums[k] += a[i + k] * b[i + k];
  for (; i < count; ++i) sums[0] += a[i] * b[i];
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

/// A signal about its mean, with the sums of its values and squares up to every sample.
struct Summed {
  std::vector<double> values;
  std::vector<double> sum = {0.0};
  std::vector<double> squares = {0.0};

  explicit Summed(std::span<const double> signal) : values(signal.begin(), signal.end()) {
    const double level = mean(values).value;
    for (double& value : values) {
      value -= level;
      sum.push_back(sum.back() + value);
      squares.push_back(squares.back() + value * value);
    }
  }
  /// Sum of squares about the mean over [begin, begin + count).
  [[nodiscard]] double variation(std::size_t begin, std::size_t count) const {
    const double s = sum_of(begin, count);
    return squares[begin + count] - squares[begin] - s * s / static_cast<double>(count);
  }
  [[nodiscard]] double sum_of(std::size_t begin, std::size_t count) const { return sum[begin + count] - sum[begin]; }
};

/// Over the overlap of channel and reference delayed by `lag` samples.
double correlation_at(const Summed& reference, const Summed& channel, std::ptrdiff_t lag) {
  const auto in_channel = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, lag));
  const auto in_reference = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, -lag));
  const std::size_t count = channel.values.size() - in_channel - in_reference;
  const double variance = reference.variation(in_reference, count) * channel.variation(in_channel, count);
  const double product =
      dot(&reference.values[in_reference], &channel.values[in_channel], count) -
      reference.sum_of(in_reference, count) * channel.sum_of(in_channel, count) / static_cast<double>(count);
  return variance > 0.0 ? product / std::sqrt(variance) : 0.0;
}

/// Cubic Hermite value and slope (per sample) at a fractional index inside 1..size-3.
struct ValueAndSlope {
  double value;
  double slope;
};
ValueAndSlope hermite(std::span<const double> values, double index) {
  const auto i = static_cast<std::size_t>(index);
  const double u = index - static_cast<double>(i);
  const double left = 0.5 * (values[i + 1] - values[i - 1]);
  const double right = 0.5 * (values[i + 2] - values[i]);
  const double change = values[i + 1] - values[i];
  const double c2 = 3.0 * change - 2.0 * left - right;
  const double c3 = left + right - 2.0 * change;
  return {values[i] + u * (left + u * (c2 + u * c3)), left + u * (2.0 * c2 + 3.0 * u * c3)};
}

struct Refinement {
  double step = 0.0;  ///< of the offset, in samples
  double step_std = 0.0;
  double gain = 0.0;
  double correlation = 0.0;
};

/// One linearised least-squares step: y - mean = g (r - mean) + h (r' - mean), offset step = -h / g.
std::optional<Refinement> refine(std::span<const double> reference, std::span<const double> channel, double offset) {
  std::vector<double> r, s, y;
  for (std::size_t i = 0; i < channel.size(); ++i) {
    const double index = static_cast<double>(i) - offset;
    if (index < 1.0 || index >= static_cast<double>(reference.size()) - 2.0) continue;
    const ValueAndSlope at = hermite(reference, index);
    r.push_back(at.value);
    s.push_back(at.slope);
    y.push_back(channel[i]);
  }
  if (y.size() < 8) return std::nullopt;
  const double r_mean = mean(r).value;
  const double s_mean = mean(s).value;
  const double y_mean = mean(y).value;
  double rr = 0, rs = 0, ss = 0, ry = 0, sy = 0, yy = 0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    r[i] -= r_mean, s[i] -= s_mean, y[i] -= y_mean;
    rr += r[i] * r[i], rs += r[i] * s[i], ss += s[i] * s[i];
    ry += r[i] * y[i], sy += s[i] * y[i], yy += y[i] * y[i];
  }
  const double determinant = rr * ss - rs * rs;
  if (determinant <= 1e-12 * rr * ss || yy <= 0.0) return std::nullopt;
  const double gain = (ss * ry - rs * sy) / determinant;
  const double slope_gain = (rr * sy - rs * ry) / determinant;
  if (gain == 0.0) return std::nullopt;
  double square = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    y[i] -= gain * r[i] + slope_gain * s[i];
    square += y[i] * y[i];
  }
  const double variance = square / static_cast<double>(y.size()) * autocorrelation_factor(y);
  return Refinement{.step = -slope_gain / gain,
                    .step_std = std::sqrt(variance * rr / determinant) / std::abs(gain),
                    .gain = gain,
                    .correlation = ry / std::sqrt(rr * yy)};
}

}  // namespace

namespace {

/// Lags tried on either side. At a higher rate the search first goes over every n-th row: what is compared is smooth
/// (a few hertz), so that its correlation cannot have a peak between two of them that neither shows.
constexpr std::ptrdiff_t kMostLags = 2000;

std::vector<double> every(std::span<const double> values, std::ptrdiff_t step) {
  std::vector<double> result;
  for (std::size_t i = 0; i < values.size(); i += static_cast<std::size_t>(step)) result.push_back(values[i]);
  return result;
}

struct BestLag {
  std::ptrdiff_t lag = 0;
  double correlation = 0.0;
};

BestLag best_lag(std::span<const double> reference, std::span<const double> channel, std::ptrdiff_t from,
                 std::ptrdiff_t to) {
  BestLag best;
  const Summed summed_reference(reference);
  const Summed summed_channel(channel);
  for (std::ptrdiff_t lag = from; lag <= to; ++lag) {
    const double correlation = std::abs(correlation_at(summed_reference, summed_channel, lag));
    if (correlation > best.correlation) best = {lag, correlation};
  }
  return best;
}

/// Over [-largest, largest].
BestLag best_lag(std::span<const double> reference, std::span<const double> channel, std::ptrdiff_t largest) {
  const std::ptrdiff_t step = (largest + kMostLags - 1) / kMostLags;
  if (step <= 1) return best_lag(reference, channel, -largest, largest);
  const std::ptrdiff_t coarse =
      step * best_lag(every(reference, step), every(channel, step), -largest / step, largest / step).lag;
  return best_lag(reference, channel, std::max(-largest, coarse - step), std::min(largest, coarse + step));
}

}  // namespace

std::optional<OffsetEstimate> estimate_offset(std::span<const double> reference, std::span<const double> channel,
                                              double interval_s, double largest_offset_s) {
  assert(reference.size() == channel.size());
  const auto count = static_cast<std::ptrdiff_t>(channel.size());
  const std::ptrdiff_t largest = std::min(static_cast<std::ptrdiff_t>(largest_offset_s / interval_s), count / 2);
  if (count < 16 || largest < 1) return std::nullopt;
  const BestLag best = best_lag(reference, channel, largest);
  if (best.correlation <= 0.0 || std::abs(best.lag) == largest) return std::nullopt;
  auto offset = static_cast<double>(best.lag);
  std::optional<Refinement> refinement;
  for (int iteration = 0; iteration < 4; ++iteration) {
    refinement = refine(reference, channel, offset);
    if (!refinement) return std::nullopt;
    offset += std::clamp(refinement->step, -1.0, 1.0);  // the search has already found the right sample
  }
  return OffsetEstimate{.offset_s = offset * interval_s,
                        .offset_std_s = refinement->step_std * interval_s,
                        .gain = refinement->gain,
                        .correlation = refinement->correlation};
}

}  // namespace sealwatch::signal
