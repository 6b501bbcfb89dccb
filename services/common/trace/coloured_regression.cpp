#include "sealwatch/trace/coloured_regression.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "services/common/dense/dense.hpp"

namespace sealwatch::trace {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Burg's lattice: hands each order's coefficients and prediction-error power to `each`.
template <class Each>
void burg_orders(std::span<const double> values, std::size_t largest, const Each& each) {
  const std::size_t n = values.size();
  std::vector<double> forward(values.begin(), values.end()), backward = forward, a;
  double power = 0.0;
  for (const double value : values) power += value * value;
  power /= static_cast<double>(n);
  each(a, power);
  for (std::size_t order = 1; order <= largest && order < n && power > 0.0; ++order) {
    double product = 0.0, squares = 0.0;
    for (std::size_t t = order; t < n; ++t) {
      product += forward[t] * backward[t - 1];
      squares += forward[t] * forward[t] + backward[t - 1] * backward[t - 1];
    }
    if (!(squares > 0.0)) return;
    const double reflection = 2.0 * product / squares;
    std::vector<double> next(order);
    for (std::size_t k = 0; k + 1 < order; ++k) next[k] = a[k] - reflection * a[order - 2 - k];
    next[order - 1] = reflection;
    a = std::move(next);
    for (std::size_t t = n - 1; t >= order; --t) {
      const double ahead = forward[t];
      forward[t] = ahead - reflection * backward[t - 1];
      backward[t] = backward[t - 1] - reflection * ahead;
    }
    power *= 1.0 - reflection * reflection;
    each(a, power);
  }
}

constexpr int kRounds = 4;  // of noise and regression in turn: the likelihood stays then to a thousandth

}  // namespace

std::vector<double> burg(std::span<const double> values, std::size_t order) {
  std::vector<double> coefficients;
  burg_orders(values, order, [&](const std::vector<double>& a, double) { coefficients = a; });
  coefficients.resize(order);
  return coefficients;
}

std::size_t choose_order(std::span<const double> values, std::size_t largest) {
  const auto n = static_cast<double>(values.size());
  double best = std::numeric_limits<double>::infinity();
  std::size_t order = 0;
  burg_orders(values, largest, [&](const std::vector<double>& a, double power) {
    const double criterion = power > 0.0 ? n * std::log(power) + static_cast<double>(a.size()) * std::log(n) : best;
    if (criterion < best) best = criterion, order = a.size();
  });
  return order;
}

Joints joints_within(const Joints& joints, Index first, Index count) {
  Joints inside;
  for (const Index joint : joints)
    if (joint > first && joint < first + count) inside.push_back(joint - first);
  return inside;
}

std::vector<Index> whole_windows(Index count, std::size_t first, const Joints& joints) {
  std::vector<Index> rows;
  const auto window = static_cast<Index>(first);
  auto next = joints.begin();
  for (Index t = window; t < count; ++t) {
    while (next != joints.end() && *next <= t - window) ++next;
    if (next == joints.end() || *next > t) rows.push_back(t);
  }
  return rows;
}

MatrixXd whitened(const MatrixXd& columns, const std::vector<double>& coefficients, std::size_t first,
                  const Joints& joints) {
  assert(first >= coefficients.size());
  const auto skipped = static_cast<Index>(first);
  const Index rows = columns.rows() - skipped;
  MatrixXd out = columns.bottomRows(rows);
  for (std::size_t k = 0; k < coefficients.size(); ++k)
    out -= coefficients[k] * columns.middleRows(skipped - static_cast<Index>(k) - 1, rows);
  if (joints.empty()) return out;
  std::vector<Index> kept = whole_windows(columns.rows(), first, joints);
  for (Index& row : kept) row -= skipped;
  return out(kept, Eigen::all);
}

ColouredFit fit_coloured(const VectorXd& y, const MatrixXd& X, std::size_t order, std::size_t first,
                         double least_variance, const Joints& joints) {
  ColouredFit fit;
  fit.beta = VectorXd::Zero(X.cols());
  const auto n = static_cast<double>(whole_windows(y.size(), first, joints).size());
  fit.coefficients.assign(order, 0.0);
  for (int round = 0; round <= kRounds; ++round) {
    const MatrixXd design = whitened(X, fit.coefficients, first, joints);
    const VectorXd target = whitened(y, fit.coefficients, first, joints);
    if (X.cols() > 0) {
      dense::LeastSquares least = dense::least_squares(design, target);
      fit.beta = std::move(least.solution);
      fit.covariance = std::move(least.unscaled_covariance);
    }
    fit.residual = y - X * fit.beta;
    fit.innovation_variance =
        std::max(whitened(fit.residual, fit.coefficients, first, joints).squaredNorm() / n, least_variance);
    if (round < kRounds)
      fit.coefficients = burg({fit.residual.data(), static_cast<std::size_t>(fit.residual.size())}, order);
  }
  fit.covariance *= fit.innovation_variance;
  fit.minus_two_log_likelihood = n * std::log(fit.innovation_variance);
  return fit;
}

double effective_samples(const VectorXd& noise, const std::vector<double>& coefficients) {
  const auto n = static_cast<double>(noise.size());
  double at_rest = 1.0;
  for (const double a : coefficients) at_rest -= a;
  const auto p = coefficients.size();
  const double innovation = whitened(noise, coefficients, p).squaredNorm() / (n - static_cast<double>(p));
  if (!(innovation > 0.0)) return n;
  return std::clamp(n * noise.squaredNorm() / n * at_rest * at_rest / innovation, 1.0, n);
}

}  // namespace sealwatch::trace
