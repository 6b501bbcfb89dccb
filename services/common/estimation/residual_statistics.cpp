#include "sealwatch/estimation/residual_statistics.hpp"

#include <algorithm>
#include <cmath>

#include "sealwatch/signal/statistics.hpp"
#include "services/common/dense/dense.hpp"

namespace sealwatch {
namespace {

/// A recorded channel that spreads less than this share of its size is constant up to rounding.
constexpr double kRounding = 1e-12;

constexpr std::size_t kFewestSamples = 8;
constexpr double kCollinearity = 1e-9;  // of the largest column: below it a lagged input says nothing new

Eigen::VectorXd centred(std::span<const double> values) {
  const Eigen::Map<const Eigen::VectorXd> vector(values.data(), static_cast<Eigen::Index>(values.size()));
  return vector.array() - vector.mean();
}

}  // namespace

double nrmse_percent(std::span<const double> recorded, std::span<const double> simulated) {
  const auto size = static_cast<Eigen::Index>(std::min(recorded.size(), simulated.size()));
  if (size == 0) return 0.0;
  const Eigen::Map<const Eigen::VectorXd> y(recorded.data(), size), y_hat(simulated.data(), size);
  const double spread = (y.array() - y.mean()).matrix().norm();
  return spread > kRounding * y.norm() ? 100.0 * (1.0 - (y - y_hat).norm() / spread) : 0.0;
}

double root_mean_square(std::span<const double> whitened_residual) {
  if (whitened_residual.empty()) return 0.0;
  double sum = 0.0;
  for (const double value : whitened_residual) sum += value * value;
  return std::sqrt(sum / static_cast<double>(whitened_residual.size()));
}

double whiteness_p(std::span<const double> residual, std::size_t lags) {
  if (residual.size() < kFewestSamples) return 1.0;
  const Eigen::VectorXd e = centred(residual);
  const double n = static_cast<double>(e.size());
  const double variance = e.squaredNorm();
  if (!(variance > 0.0)) return 1.0;
  const Eigen::Index last = static_cast<Eigen::Index>(std::min(lags, residual.size() / 4));
  double q = 0.0;
  for (Eigen::Index k = 1; k <= last; ++k) {
    const double rho = e.head(e.size() - k).dot(e.tail(e.size() - k)) / variance;
    q += rho * rho / (n - static_cast<double>(k));
  }
  return signal::chi_squared_tail(n * (n + 2.0) * q, static_cast<double>(last));
}

PastInput::PastInput(std::span<const double> input, std::size_t span, std::size_t lags) {
  lags = std::max<std::size_t>(1, lags);
  const std::size_t spacing = std::max<std::size_t>(1, span / lags);
  first_ = spacing * (lags - 1);
  if (input.size() < first_ + 4 * lags) return;
  const std::size_t rows = input.size() - first_;
  Eigen::MatrixXd lagged(rows, lags);
  for (std::size_t k = 0; k < lags; ++k)
    lagged.col(static_cast<Eigen::Index>(k)) = centred(input.subspan(first_ - k * spacing, rows));
  basis_ = dense::orthonormal_basis(lagged, kCollinearity);
}

double PastInput::independence_p(std::span<const double> residual) const {
  if (basis_.cols() == 0 || residual.size() != first_ + static_cast<std::size_t>(basis_.rows())) return 1.0;
  const Eigen::VectorXd e = centred(residual.subspan(first_));
  const double variance = e.squaredNorm();
  if (!(variance > 0.0)) return 1.0;
  const double explained = (basis_.transpose() * e).squaredNorm() / variance;
  return signal::chi_squared_tail(explained * static_cast<double>(e.size()), static_cast<double>(basis_.cols()));
}

}  // namespace sealwatch
