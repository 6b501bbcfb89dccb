#include "services/common/trace/difference_tests.hpp"

#include <algorithm>
#include <cmath>

#include "sealwatch/signal/statistics.hpp"
#include "sealwatch/trace/coloured_regression.hpp"
#include "services/common/dense/dense.hpp"

namespace sealwatch::trace {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kLargestOrder = 30;
constexpr Index kSamplesAnOrder = 20;
constexpr double kCollinear = 1e-8;  // of the largest column: below it a column says nothing new

double chi_squared_p(double statistic, Index degrees) {
  return signal::chi_squared_tail(statistic, static_cast<double>(degrees));
}

/// Orthonormal columns that span the same; fewer where some say nothing new.
MatrixXd independent(const MatrixXd& columns) { return dense::orthonormal_basis_of_scaled(columns, kCollinear); }

std::size_t order_of(const VectorXd& noise) {
  const auto largest = std::min<std::size_t>(kLargestOrder, static_cast<std::size_t>(noise.size() / kSamplesAnOrder));
  return choose_order({noise.data(), static_cast<std::size_t>(noise.size())}, largest);
}

/// 1 for samples that the simulation leaves open by less than the innovations scatter, 0 for others.
VectorXd well_known(const VectorXd& between, Index samples, const VectorXd& innovations) {
  constexpr double kNothing = 0.1;  // of the innovations' median square
  if (between.size() == 0) return VectorXd::Ones(samples);
  std::vector<double> squares(innovations.begin(), innovations.end());
  for (double& square : squares) square *= square;
  const double usual = signal::median(squares);
  return (between.array() <= kNothing * usual).cast<double>();
}

constexpr double kFewestInAPart = 20.0;

/// p-value that innovations scatter alike in all parts.
double spread_p(const VectorXd& innovations, const MatrixXd& parts, double least_variance) {
  double statistic = 0.0, samples = 0.0, fourth = 0.0, pooled = 0.0;
  Index used = 0;
  const Eigen::ArrayXd squares = innovations.array().square();
  std::vector<std::pair<double, double>> variances;
  for (Index k = 0; k < parts.cols(); ++k) {
    const Eigen::ArrayXd inside = parts.col(k).array();
    const double n = inside.sum();
    if (n < kFewestInAPart) continue;
    const double variance = std::max((squares * inside).sum() / n, least_variance);
    variances.emplace_back(n, variance);
    fourth += (squares.square() * inside).sum() / (variance * variance);
    pooled += n * variance, samples += n, ++used;
  }
  if (used < 2) return 1.0;
  const double kurtosis = std::max(fourth / samples, 3.0);
  for (const auto& [n, variance] : variances) statistic += n * std::log(pooled / samples / variance);
  return chi_squared_p(2.0 * statistic / (kurtosis - 1.0), used - 1);
}

}  // namespace

NoiseTest test_noise(const VectorXd& residual, const std::vector<RegressorGroup>& groups,
                     const std::vector<RegressorGroup>& partitions, const LeastVariances& least, const Joints& joints) {
  const double least_variance = least.arithmetic + (least.between.size() > 0 ? least.between.mean() : 0.0);
  NoiseTest test;
  MatrixXd all(residual.size(), 0);
  for (const RegressorGroup& group : groups) {
    all.conservativeResize(Eigen::NoChange, all.cols() + group.columns.cols());
    all.rightCols(group.columns.cols()) = group.columns;
  }
  all = independent(all);
  const ColouredFit explained = fit_coloured(residual, all, order_of(residual), kLargestOrder, least_variance, joints);
  const std::size_t order = std::max(order_of(residual), order_of(explained.residual));
  const ColouredFit noise =
      fit_coloured(residual, MatrixXd(residual.size(), 0), order, kLargestOrder, least_variance, joints);
  const ColouredFit whole = fit_coloured(residual, all, order, kLargestOrder, least_variance, joints);
  test.effective_samples = effective_samples(whole.residual, whole.coefficients);
  test.noise_std =
      std::sqrt(std::max(whole.residual.squaredNorm() / static_cast<double>(residual.size()), least_variance));
  for (const RegressorGroup& group : groups) {
    const MatrixXd columns = independent(group.columns);
    const ColouredFit fit = fit_coloured(residual, columns, order, kLargestOrder, least_variance, joints);
    const double gain = noise.minus_two_log_likelihood - fit.minus_two_log_likelihood;
    test.groups.push_back({group.name, chi_squared_p(gain, columns.cols())});
  }
  const VectorXd innovations = whitened(noise.residual, noise.coefficients, kLargestOrder, joints);
  const std::vector<Index> rows = whole_windows(residual.size(), kLargestOrder, joints);
  double rounding = std::max(least.steps, least_variance);
  for (const double a : noise.coefficients) rounding += a * a * least.steps;
  const VectorXd known = well_known(least.between, residual.size(), innovations)(rows);
  for (const RegressorGroup& partition : partitions) {
    const MatrixXd parts = known.asDiagonal() * MatrixXd(partition.columns(rows, Eigen::all));
    test.groups.push_back({partition.name, spread_p(innovations, parts, rounding)});
  }
  for (const GroupTest& group : test.groups)
    test.p_value = std::min(test.p_value, group.p_value * static_cast<double>(test.groups.size()));
  return test;
}

}  // namespace sealwatch::trace
