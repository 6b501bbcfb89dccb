// What the residuals of a fit say about it.
//
//   NRMSE fit            100 (1 - |y - y_hat| / |y - mean(y)|)  percent; 100 is perfect, 0 no better than the mean
//   noise-normalised rms sqrt(mean(((y - y_hat) / sigma)^2)); 1 is the floor
//   whiteness            Ljung and Box, Q = n (n + 2) sum_{k=1}^{m} rho_k^2 / (n - k) ~ chi^2(m) for white residuals
//   independence         n R^2 of the residual regressed on past input u(t - tau_1), ..., u(t - tau_m)
//                        ~ chi^2(rank) for
//                        residuals that are white and owe nothing to the input (Ljung, System Identification, 16.6)
//
// p-values near 0 mean: not white, not independent.
#pragma once

#include <Eigen/Core>
#include <span>

namespace sealwatch {

[[nodiscard]] double nrmse_percent(std::span<const double> recorded, std::span<const double> simulated);

[[nodiscard]] double root_mean_square(std::span<const double> whitened_residual);

/// p-value of the Ljung-Box statistic over `lags` lags (at most a quarter of the samples); 1 for fewer than 8 samples.
[[nodiscard]] double whiteness_p(std::span<const double> residual, std::size_t lags = 20);

/// The past inputs of one recording, orthogonalised once for all channels' residuals.
class PastInput {
 public:
  /// `input` as sampled; `span` samples of its past are looked at, through `lags` evenly spaced delays from 0.
  PastInput(std::span<const double> input, std::size_t span, std::size_t lags = 10);
  /// p-value that `residual` (as many samples as the input) does not depend on the past input; 1 where that cannot be
  /// told.
  [[nodiscard]] double independence_p(std::span<const double> residual) const;

 private:
  std::size_t first_ = 0;  // samples without a complete past
  Eigen::MatrixXd basis_;  // orthonormal, of the lagged and centred inputs
};

}  // namespace sealwatch
