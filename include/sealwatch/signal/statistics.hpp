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

/// P(chi^2 with that many degrees of freedom > statistic). 1 without any degree of freedom, and where the statistic is
/// not a number.
[[nodiscard]] double chi_squared_tail(double statistic, double degrees_of_freedom);

}  // namespace sealwatch::signal
