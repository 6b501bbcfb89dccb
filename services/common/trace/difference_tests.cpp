#include "services/common/trace/difference_tests.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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
constexpr double kRounding = 1e-12;   // of a column's length
constexpr double kCollinear = 1e-11;  // of a column's square about its mean: what is less says nothing new

double chi_squared_p(double statistic, Index degrees) {
  return signal::chi_squared_tail(statistic, static_cast<double>(degrees));
}

/// The groups' columns side by side behind a constant, about their means and of length 1, and which of them say something
/// new: of all, and of each group.
struct Regressors {
  MatrixXd columns;
  std::vector<Index> all;
  std::vector<std::vector<Index>> of_group;
};

Regressors regressors_of(std::vector<RegressorGroup>& groups, Index samples) {
  Index count = 1;
  for (const RegressorGroup& group : groups) count += static_cast<Index>(group.columns.size());
  Regressors out{.columns = MatrixXd(samples, count), .all = {}, .of_group = {}};
  out.columns.col(0).setConstant(1.0 / std::sqrt(static_cast<double>(samples)));
  Index next = 1;
  for (RegressorGroup& group : groups) {
    out.of_group.push_back({0});
    for (const VectorXd& column : std::exchange(group.columns, {})) {
      out.columns.col(next) = column.array() - column.mean();
      const double length = out.columns.col(next).norm();
      if (length > kRounding * column.norm()) out.columns.col(next) /= length, out.of_group.back().push_back(next);
      ++next;
    }
  }
  const MatrixXd gram = whitened_gram(out.columns, VectorXd::Zero(samples), {}, 0);
  const auto independent = [&gram](const std::vector<Index>& columns) {
    std::vector<Index> chosen = dense::independent_columns(gram(columns, columns), kCollinear);
    for (Index& column : chosen) column = columns[static_cast<std::size_t>(column)];
    std::ranges::sort(chosen);
    return chosen;
  };
  for (std::vector<Index>& group : out.of_group) {
    out.all.insert(out.all.end(), group.begin() + (out.all.empty() ? 0 : 1), group.end());
    group = independent(group);
  }
  out.all = independent(out.all);
  return out;
}

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
double spread_p(const VectorXd& innovations, const std::vector<VectorXd>& parts, double least_variance) {
  double statistic = 0.0, samples = 0.0, fourth = 0.0, pooled = 0.0;
  Index used = 0;
  const Eigen::ArrayXd squares = innovations.array().square();
  std::vector<std::pair<double, double>> variances;
  for (const VectorXd& part : parts) {
    const Eigen::ArrayXd inside = part.array();
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

NoiseTest test_noise(const VectorXd& residual, std::vector<RegressorGroup> groups,
                     const std::vector<RegressorGroup>& partitions, const LeastVariances& least, const Joints& joints) {
  const double least_variance = least.arithmetic + (least.between.size() > 0 ? least.between.mean() : 0.0);
  NoiseTest test;
  const Regressors regressors = regressors_of(groups, residual.size());
  const auto fit = [&](const std::vector<Index>& columns, std::size_t order) {
    return fit_coloured(residual, regressors.columns(Eigen::all, columns), order, kLargestOrder, least_variance,
                        joints);
  };
  const std::size_t at_least = order_of(residual);
  ColouredFit whole = fit(regressors.all, at_least);
  const std::size_t order = std::max(at_least, order_of(whole.residual));
  if (order > at_least) whole = fit(regressors.all, order);
  const ColouredFit noise = fit({}, order);
  test.effective_samples = effective_samples(whole.residual, whole.coefficients);
  test.noise_std =
      std::sqrt(std::max(whole.residual.squaredNorm() / static_cast<double>(residual.size()), least_variance));
  for (std::size_t k = 0; k < groups.size(); ++k) {
    const ColouredFit group = fit(regressors.of_group[k], order);
    const double gain = noise.minus_two_log_likelihood - group.minus_two_log_likelihood;
    test.groups.push_back({groups[k].name, chi_squared_p(gain, group.beta.size())});
  }
  const VectorXd innovations = whitened(noise.residual, noise.coefficients, kLargestOrder, joints);
  const std::vector<Index> rows = whole_windows(residual.size(), kLargestOrder, joints);
  double rounding = std::max(least.steps, least_variance);
  for (const double a : noise.coefficients) rounding += a * a * least.steps;
  const VectorXd known = well_known(least.between, residual.size(), innovations)(rows);
  for (const RegressorGroup& partition : partitions) {
    std::vector<VectorXd> parts;
    for (const VectorXd& part : partition.columns) parts.emplace_back(known.cwiseProduct(part(rows)));
    test.groups.push_back({partition.name, spread_p(innovations, parts, rounding)});
  }
  for (const GroupTest& group : test.groups)
    test.p_value = std::min(test.p_value, group.p_value * static_cast<double>(test.groups.size()));
  return test;
}

}  // namespace sealwatch::trace
