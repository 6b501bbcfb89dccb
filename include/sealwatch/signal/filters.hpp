// Low-pass filters with stated phase.
//
// Butterworth of even order n as n/2 biquads by the bilinear transform, cut-off prewarped:
//   |H(f)|^2 = 1 / (1 + (tan(pi f/f_s) / tan(pi f_c/f_s))^(2n)),   f_s sample rate, f_c cut-off [Hz]
// One pass delays; forward and backward gives |H(f)|^2 and no phase at all (-6 dB at f_c). The ends are continued by
// point reflection, so that a ramp stays a ramp.
//
// First-order lag tau dy/dt = u - y with u linear between samples (what a sensor does, exactly).
#pragma once

#include <span>
#include <vector>

namespace sealwatch::signal {

class LowPass {
 public:
  /// `order` even and positive, 0 < cutoff_Hz < sample_rate_Hz / 2.
  [[nodiscard]] static LowPass butterworth(int order, double cutoff_Hz, double sample_rate_Hz);

  /// One causal pass, started in the steady state of the first value.
  [[nodiscard]] std::vector<double> apply(std::span<const double> values) const;
  /// Forward and backward: zero phase.
  [[nodiscard]] std::vector<double> apply_zero_phase(std::span<const double> values) const;
  /// |H(f)| of one pass.
  [[nodiscard]] double gain(double frequency_Hz) const;
  /// Standard deviation of white noise of standard deviation 1 after the zero-phase filter.
  [[nodiscard]] double zero_phase_noise_gain() const;
  /// Samples over which the impulse response matters; within this of an end the filter leans on the reflection.
  [[nodiscard]] std::size_t settling_samples() const;

 private:
  struct Biquad {
    double b0, b1, b2, a1, a2;
  };
  std::vector<Biquad> sections_;
  double cutoff_Hz_ = 0.0;
  double sample_rate_Hz_ = 0.0;
};

[[nodiscard]] std::vector<double> first_order_lag(std::span<const double> values, double time_constant_s,
                                                  double interval_s);

/// Central differences, one-sided at the ends; `values` per `interval_s`, at least two.
[[nodiscard]] std::vector<double> derivative(std::span<const double> values, double interval_s);

/// Trapezoidal integral from 0.
[[nodiscard]] std::vector<double> integral(std::span<const double> values, double interval_s);

}  // namespace sealwatch::signal
