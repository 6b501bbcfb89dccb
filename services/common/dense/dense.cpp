#include "services/common/dense/dense.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
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

LeastSquares least_squares(const View& a, const VectorXd& b) {
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(a);
  const Eigen::Index rank = qr.rank();
  const MatrixXd root =
      qr.matrixR().topLeftCorner(rank, rank).triangularView<Eigen::Upper>().solve(MatrixXd::Identity(rank, rank));
  MatrixXd permuted = MatrixXd::Zero(a.cols(), a.cols());
  permuted.topLeftCorner(rank, rank) = product_transposed(root, root);
  return {.solution = qr.solve(b),
          .unscaled_covariance = qr.colsPermutation() * permuted * qr.colsPermutation().transpose()};
}

}  // namespace sealwatch::dense
