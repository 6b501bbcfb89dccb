// Robust and classical statistics of sampled signals.
//
// Neighbouring samples of a filtered or drifting signal are not independent. Standard errors here count them by the
// lag-one autocorrelation rho of what is left over: effective number n (1 - rho) / (1 + rho), rho limited to 0..0.99.
#pragma once

#include <span>
#include <vector>

namespace sealwatch::signal {

struct Estimate {
  double value = 0.0;
  double std_error = 0.0;
};

/// Quantile by linear interpolation between order statistics; `values` must not be empty.
[[nodiscard]] double quantile(std::vector<double> values, double probability);
[[nodiscard]] inline double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

/// Factor (1 + rho) / (1 - rho) by which the variance of a mean of these (zero-mean) residuals exceeds the white one's.
[[nodiscard]] double autocorrelation_factor(std::span<const double> residuals);

/// Mean of at least two values.
[[nodiscard]] Estimate mean(std::span<const double> values);

/// Slope of the least-squares line through at least three equally spaced values, per `interval_s`.
[[nodiscard]] Estimate slope(std::span<const double> values, double interval_s);

/// Mean weighted by 1 / std_error^2.
[[nodiscard]] Estimate weighted_mean(std::span<const Estimate> estimates);

/// Standard deviation of the white noise on a smooth signal, in the unit of the values: median |Delta^4 y| / 0.6745 /
/// sqrt(70). Fourth differences remove every cubic; 70 = 1 + 16 + 36 + 16 + 1 is what they make of a unit variance; the
/// median keeps jumps out. Differences of exactly zero do not count: a sensor that rests on one step shows no noise. A
/// sensor's step q (the smallest change found) limits it from below to q / sqrt(12). Not finite values are passed over;
/// 0 for fewer than 16 values.
[[nodiscard]] double estimate_noise_std(std::span<const double> values);

}  // namespace sealwatch::signal
