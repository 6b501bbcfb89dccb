#include "sealwatch/signal/statistics.hpp"

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cassert>
#include <cmath>
#include <numeric>

namespace sealwatch::signal {
namespace {

constexpr double kLargestCorrelation = 0.99;  // a drifting signal still counts as a few independent values

}  // namespace

double quantile(std::vector<double> values, double probability) {
  assert(!values.empty());
  const double place = probability * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(below);
  std::nth_element(values.begin(), at, values.end());
  if (below + 1 >= values.size()) return *at;
  const double next = *std::min_element(at + 1, values.end());
  return *at + (place - static_cast<double>(below)) * (next - *at);
}

double autocorrelation_factor(std::span<const double> residuals) {
  double square = 0.0;
  double product = 0.0;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    square += residuals[i] * residuals[i];
    if (i > 0) product += residuals[i] * residuals[i - 1];
  }
  if (square <= 0.0) return 1.0;
  const double rho = std::clamp(product / square, 0.0, kLargestCorrelation);
  return (1.0 + rho) / (1.0 - rho);
}

Estimate mean(std::span<const double> values) {
  assert(values.size() >= 2);
  const auto count = static_cast<double>(values.size());
  const double average = std::accumulate(values.begin(), values.end(), 0.0) / count;
  std::vector<double> residuals(values.begin(), values.end());
  double square = 0.0;
  for (double& residual : residuals) {
    residual -= average;
    square += residual * residual;
  }
  return {average, std::sqrt(square / (count - 1.0) / count * autocorrelation_factor(residuals))};
}

Estimate slope(std::span<const double> values, double interval_s) {
  assert(values.size() >= 3);
  const auto count = static_cast<double>(values.size());
  const double middle = (count - 1.0) / 2.0;
  const double average = std::accumulate(values.begin(), values.end(), 0.0) / count;
  double product = 0.0;
  double spread = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double place = static_cast<double>(i) - middle;
    product += place * (values[i] - average);
    spread += place * place;
  }
  const double per_sample = product / spread;
  std::vector<double> residuals(values.size());
  double square = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    residuals[i] = values[i] - average - per_sample * (static_cast<double>(i) - middle);
    square += residuals[i] * residuals[i];
  }
  const double variance = square / (count - 2.0) / spread * autocorrelation_factor(residuals);
  return {per_sample / interval_s, std::sqrt(variance) / interval_s};
}

Estimate weighted_mean(std::span<const Estimate> estimates) {
  assert(!estimates.empty());
  double weights = 0.0;
  double sum = 0.0;
  for (const Estimate& estimate : estimates) {
    if (estimate.std_error <= 0.0) return estimate;  // an exact value outweighs all others
    const double weight = 1.0 / (estimate.std_error * estimate.std_error);
    weights += weight;
    sum += weight * estimate.value;
  }
  return {sum / weights, 1.0 / std::sqrt(weights)};
}

double chi_squared_tail(double statistic, double degrees_of_freedom) {
  if (!(statistic > 0.0) || !(degrees_of_freedom > 0.0)) return 1.0;
  if (std::isinf(statistic)) return 0.0;
  if (degrees_of_freedom == 1.0) return std::erfc(std::sqrt(0.5 * statistic));  // these two are most of the calls
  if (degrees_of_freedom == 2.0) return std::exp(-0.5 * statistic);
  return boost::math::gamma_q(0.5 * degrees_of_freedom, 0.5 * statistic);
}

}  // namespace sealwatch::signal
