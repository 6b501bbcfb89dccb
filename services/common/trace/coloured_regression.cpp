#include "sealwatch/trace/coloured_regression.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "services/common/dense/dense.hpp"
#include "services/common/dense/row_products.hpp"

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
constexpr double kStays = 1e-3;
constexpr Index kBlock = 256;  // rows that are filtered at once: they stay in the cache

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// w_t of `out.rows()` rows from t = `row` on.
void filter(const Eigen::Ref<const MatrixXd>& columns, const std::vector<double>& coefficients, Index row,
            Eigen::Ref<MatrixXd> out) {
  assert(row >= static_cast<Index>(coefficients.size()));
  out = columns.middleRows(row, out.rows());
  for (Index c = 0; c < out.cols(); ++c)
    for (std::size_t k = 0; k < coefficients.size(); ++k)
      out.col(c) -= coefficients[k] * columns.col(c).segment(row - static_cast<Index>(k) - 1, out.rows());
}

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

MatrixXd whitened(const Eigen::Ref<const MatrixXd>& columns, const std::vector<double>& coefficients, std::size_t first,
                  const Joints& joints) {
  const auto skipped = static_cast<Index>(first);
  MatrixXd out(std::max<Index>(columns.rows() - skipped, 0), columns.cols());
  for (Index row = 0; row < out.rows(); row += kBlock) {
    const Index rows = std::min(kBlock, out.rows() - row);
    filter(columns, coefficients, skipped + row, out.middleRows(row, rows));
  }
  if (joints.empty()) return out;
  std::vector<Index> kept = whole_windows(columns.rows(), first, joints);
  for (Index& row : kept) row -= skipped;
  return out(kept, Eigen::all);
}

MatrixXd whitened_gram(const Eigen::Ref<const MatrixXd>& X, const VectorXd& y, const std::vector<double>& coefficients,
                       std::size_t first, const Joints& joints) {
  assert(first >= coefficients.size());
  const std::vector<Index> kept = joints.empty() ? std::vector<Index>() : whole_windows(y.size(), first, joints);
  auto next = kept.begin();
  MatrixXd gram = MatrixXd::Zero(X.cols() + 1, X.cols() + 1), white(kBlock, X.cols() + 1);
  RowMatrix rows(kBlock, X.cols() + 1);
  for (Index row = static_cast<Index>(first); row < y.size(); row += kBlock) {
    const Index count = std::min(kBlock, y.size() - row);
    filter(X, coefficients, row, white.topLeftCorner(count, X.cols()));
    filter(y, coefficients, row, white.topRightCorner(count, 1));
    Index used = 0;
    if (joints.empty())
      rows.topRows(used = count) = white.topRows(count);
    else
      for (; next != kept.end() && *next < row + count; ++next) rows.row(used++) = white.row(*next - row);
    gram += dense::gram_of_rows(rows.topRows(used));
  }
  return gram;
}

ColouredFit fit_coloured(const VectorXd& y, const Eigen::Ref<const MatrixXd>& X, std::size_t order, std::size_t first,
                         double least_variance, const Joints& joints) {
  ColouredFit fit;
  fit.beta = VectorXd::Zero(X.cols());
  fit.residual = y;
  const auto n = static_cast<double>(whole_windows(y.size(), first, joints).size());
  fit.coefficients.assign(order, 0.0);
  for (int round = 0; round <= kRounds; ++round) {
    if (X.cols() > 0) {
      // Of what is left: each round also takes away what rounding left of the one before.
      const MatrixXd gram = whitened_gram(X, fit.residual, fit.coefficients, first, joints);
      const dense::LeastSquares least =
          dense::least_squares(gram.topLeftCorner(X.cols(), X.cols()), gram.topRightCorner(X.cols(), 1));
      fit.beta += least.solution;
      fit.residual.noalias() -= X * least.solution;
      fit.covariance = least.unscaled_covariance;
    }
    const double innovation = whitened(fit.residual, fit.coefficients, first, joints).squaredNorm() / n;
    const double before = fit.minus_two_log_likelihood;
    fit.innovation_variance = std::max(innovation, least_variance);
    fit.minus_two_log_likelihood = n * std::log(fit.innovation_variance);
    const bool stays = round > 0 && std::abs(fit.minus_two_log_likelihood - before) < kStays;
    if (round == kRounds || stays) break;
    fit.coefficients = burg({fit.residual.data(), static_cast<std::size_t>(fit.residual.size())}, order);
  }
  fit.covariance *= fit.innovation_variance;
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
