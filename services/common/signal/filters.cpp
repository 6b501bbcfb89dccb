#include "sealwatch/signal/filters.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <complex>
#include <numbers>

namespace sealwatch::signal {

LowPass LowPass::butterworth(int order, double cutoff_Hz, double sample_rate_Hz) {
  assert(order > 0 && order % 2 == 0 && cutoff_Hz > 0.0 && cutoff_Hz < sample_rate_Hz / 2.0);
  LowPass filter;
  filter.cutoff_Hz_ = cutoff_Hz;
  filter.sample_rate_Hz_ = sample_rate_Hz;
  const double k = std::tan(std::numbers::pi * cutoff_Hz / sample_rate_Hz);
  for (int pair = 0; pair < order / 2; ++pair) {
    // s^2 + s/Q + 1 for each conjugate pair of poles on the unit circle, s = (1 - 1/z) / (1 + 1/z) / k.
    const double inverse_q = 2.0 * std::sin(std::numbers::pi * (2.0 * pair + 1.0) / (2.0 * order));
    const double scale = 1.0 / (1.0 + k * inverse_q + k * k);
    filter.sections_.push_back({.b0 = k * k * scale,
                                .b1 = 2.0 * k * k * scale,
                                .b2 = k * k * scale,
                                .a1 = 2.0 * (k * k - 1.0) * scale,
                                .a2 = (1.0 - k * inverse_q + k * k) * scale});
  }
  return filter;
}

std::vector<double> LowPass::apply(std::span<const double> values) const {
  std::vector<double> result(values.begin(), values.end());
  if (result.empty()) return result;
  for (const Biquad& section : sections_) {
    const double start = result.front();  // gain 1 at zero frequency: the steady state repeats its input
    double memory_1 = start - section.b0 * start;
    double memory_2 = section.b2 * start - section.a2 * start;
    for (double& value : result) {
      const double input = value;
      value = section.b0 * input + memory_1;
      memory_1 = section.b1 * input - section.a1 * value + memory_2;
      memory_2 = section.b2 * input - section.a2 * value;
    }
  }
  return result;
}

std::vector<double> LowPass::apply_zero_phase(std::span<const double> values) const {
  const std::size_t count = values.size();
  if (count < 2) return {values.begin(), values.end()};
  const std::size_t pad = std::min(count - 1, settling_samples());
  std::vector<double> padded(count + 2 * pad);
  for (std::size_t i = 0; i < pad; ++i) {
    padded[i] = 2.0 * values.front() - values[pad - i];
    padded[pad + count + i] = 2.0 * values.back() - values[count - 2 - i];
  }
  std::copy(values.begin(), values.end(), padded.begin() + static_cast<std::ptrdiff_t>(pad));
  padded = apply(padded);
  std::reverse(padded.begin(), padded.end());
  padded = apply(padded);
  std::reverse(padded.begin(), padded.end());
  const auto begin = padded.begin() + static_cast<std::ptrdiff_t>(pad);
  return {begin, begin + static_cast<std::ptrdiff_t>(count)};
}

double LowPass::gain(double frequency_Hz) const {
  const std::complex<double> delay = std::polar(1.0, -2.0 * std::numbers::pi * frequency_Hz / sample_rate_Hz_);
  std::complex<double> response = 1.0;
  for (const Biquad& s : sections_)
    response *= (s.b0 + delay * (s.b1 + delay * s.b2)) / (1.0 + delay * (s.a1 + delay * s.a2));
  return std::abs(response);
}

double LowPass::zero_phase_noise_gain() const {
  const std::size_t half = settling_samples();
  std::vector<double> impulse(2 * half + 1, 0.0);
  impulse[half] = 1.0;
  double square = 0.0;
  for (const double value : apply_zero_phase(impulse)) square += value * value;
  return std::sqrt(square);
}

std::size_t LowPass::settling_samples() const {
  // The slowest pole pair decays like exp(-2 pi f_c t / (2 Q)); two periods of the cut-off leave less than 1e-3 for
  // the orders used here.
  return static_cast<std::size_t>(std::ceil(2.0 * sample_rate_Hz_ / cutoff_Hz_));
}

std::vector<double> first_order_lag(std::span<const double> values, double time_constant_s, double interval_s) {
  std::vector<double> result(values.begin(), values.end());
  if (time_constant_s <= 0.0) return result;
  const double decay = std::exp(-interval_s / time_constant_s);
  const double ramp = time_constant_s * (1.0 - decay) / interval_s;
  for (std::size_t i = 1; i < result.size(); ++i)
    result[i] = decay * result[i - 1] + values[i] - decay * values[i - 1] - ramp * (values[i] - values[i - 1]);
  return result;
}

std::vector<double> derivative(std::span<const double> values, double interval_s) {
  assert(values.size() >= 2);
  const std::size_t last = values.size() - 1;
  std::vector<double> result(values.size());
  result[0] = (values[1] - values[0]) / interval_s;
  result[last] = (values[last] - values[last - 1]) / interval_s;
  for (std::size_t i = 1; i < last; ++i) result[i] = (values[i + 1] - values[i - 1]) / (2.0 * interval_s);
  return result;
}

std::vector<double> integral(std::span<const double> values, double interval_s) {
  std::vector<double> result(values.size(), 0.0);
  for (std::size_t i = 1; i < values.size(); ++i)
    result[i] = result[i - 1] + 0.5 * (values[i] + values[i - 1]) * interval_s;
  return result;
}

}  // namespace sealwatch::signal
