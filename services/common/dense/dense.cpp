#include "services/common/dense/dense.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>
#include <limits>

namespace sealwatch::dense {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd product(const View& a, const View& b) { return a * b; }
MatrixXd transposed_product(const View& a, const View& b) { return a.transpose() * b; }
MatrixXd product_transposed(const View& a, const View& b) { return a * b.transpose(); }
void subtract_product(Eigen::Ref<MatrixXd> c, const View& a, const View& b) { c.noalias() -= a * b; }
MatrixXd scaled(const View& a, const VectorXd& diagonal) { return diagonal.asDiagonal() * a * diagonal.asDiagonal(); }
MatrixXd inverse(const View& a) { return a.inverse(); }

Symmetric::Symmetric(const View& a) : factor_(a) {}

MatrixXd Symmetric::solve_columns(const View& b) const { return factor_.solve(b); }
VectorXd Symmetric::solve(const VectorXd& b) const { return factor_.solve(b); }

VectorXd Symmetric::lower_times(const VectorXd& z) const {
  return factor_.transpositionsP().transpose() * VectorXd(factor_.matrixL() * z);
}

MatrixXd Symmetric::root() const {
  const Eigen::Index n = factor_.rows();
  const MatrixXd permuted = factor_.transpositionsP() * MatrixXd::Identity(n, n);
  const MatrixXd upper = factor_.matrixU() * permuted;
  return factor_.vectorD().cwiseMax(0.0).cwiseSqrt().asDiagonal() * upper;
}

MatrixXd orthonormal_basis(const View& columns, double threshold) {
  if (columns.cols() == 0) return columns;
  Eigen::ColPivHouseholderQR<MatrixXd> qr(columns);
  if (threshold > 0.0) qr.setThreshold(threshold);
  const bool nothing = !(qr.maxPivot() > std::numeric_limits<double>::min());
  return qr.householderQ() * MatrixXd::Identity(columns.rows(), nothing ? 0 : qr.rank());
}

MatrixXd orthonormal_basis_of_scaled(const View& columns, double threshold) {
  MatrixXd scaled = columns;
  for (Eigen::Index k = 0; k < scaled.cols(); ++k)
    if (const double norm = scaled.col(k).norm(); norm > 0.0) scaled.col(k) /= norm;
  return orthonormal_basis(scaled, threshold);
}

std::vector<Eigen::Index> independent_columns(const MatrixXd& gram, double threshold) {
  const Eigen::Index n = gram.cols();
  const VectorXd length = gram.diagonal().cwiseMax(0.0).cwiseSqrt();
  VectorXd left = (length.array() > 0.0).cast<double>();  // of each column's square
  MatrixXd lower = MatrixXd::Zero(n, n);
  std::vector<Eigen::Index> chosen;
  Eigen::Index next = 0;
  while (static_cast<Eigen::Index>(chosen.size()) < n && left.maxCoeff(&next) > threshold) {
    const auto k = static_cast<Eigen::Index>(chosen.size());
    for (Eigen::Index i = 0; i < n; ++i) {
      if (!(length(i) > 0.0)) continue;
      const double known = lower.row(i).head(k).dot(lower.row(next).head(k));
      lower(i, k) = (gram(i, next) / (length(i) * length(next)) - known) / std::sqrt(left(next));
    }
    left -= lower.col(k).cwiseAbs2();
    left(next) = 0.0;
    chosen.push_back(next);
  }
  return chosen;
}

LeastSquares least_squares(const MatrixXd& gram, const VectorXd& product) {
  constexpr double kRounding = 1e-13;
  LeastSquares least{.solution = VectorXd::Zero(gram.cols()),
                     .unscaled_covariance = MatrixXd::Zero(gram.cols(), gram.cols())};
  const std::vector<Eigen::Index> kept = independent_columns(gram, kRounding);
  if (kept.empty()) return least;
  const MatrixXd inner = gram(kept, kept);
  const VectorXd scale = inner.diagonal().cwiseSqrt().cwiseInverse();
  const Symmetric factor(scaled(inner, scale));
  least.solution(kept) = scale.cwiseProduct(factor.solve(scale.cwiseProduct(product(kept))));
  const auto n = static_cast<Eigen::Index>(kept.size());
  least.unscaled_covariance(kept, kept) = scaled(factor.solve_columns(MatrixXd::Identity(n, n)), scale);
  return least;
}

}  // namespace sealwatch::dense
