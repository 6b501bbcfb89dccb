// Products and factorisations of dense matrices, compiled once: each form of Eigen's expressions costs seconds wherever
// it is written.
//
// A' is the transpose. Matrices of rows (RowMatrix) go in as their transpose, X.transpose(), which copies nothing.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

namespace sealwatch::dense {

/// A matrix or block whose columns lie one after another in memory; others are copied.
using View = Eigen::Ref<const Eigen::MatrixXd>;

/// A B
[[nodiscard]] Eigen::MatrixXd product(const View& a, const View& b);
/// A' B
[[nodiscard]] Eigen::MatrixXd transposed_product(const View& a, const View& b);
/// A B'
[[nodiscard]] Eigen::MatrixXd product_transposed(const View& a, const View& b);
/// C becomes C - A B.
void subtract_product(Eigen::Ref<Eigen::MatrixXd> c, const View& a, const View& b);
/// D A D, D diagonal.
[[nodiscard]] Eigen::MatrixXd scaled(const View& a, const Eigen::VectorXd& diagonal);
/// A^-1 of a square matrix; not finite where it is singular.
[[nodiscard]] Eigen::MatrixXd inverse(const View& a);

/// L D L' = A, pivoted: A symmetric, positive semidefinite.
class Symmetric {
 public:
  Symmetric() = default;
  explicit Symmetric(const View& a);

  /// A^-1 b, A^-1 B
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  [[nodiscard]] Eigen::MatrixXd solve_columns(const View& b) const;
  /// The diagonal of D, as the pivots come.
  [[nodiscard]] Eigen::VectorXd pivots() const { return factor_.vectorD(); }
  /// P' L Z: with Z = D^(1/2) z a draw whose covariance is A, where z is white.
  [[nodiscard]] Eigen::VectorXd lower_times(const Eigen::VectorXd& z) const;
  /// D^(1/2) L' P: U with U'U = A.
  [[nodiscard]] Eigen::MatrixXd root() const;

 private:
  Eigen::LDLT<Eigen::MatrixXd> factor_;
};

/// Orthonormal columns that span the same; fewer where a column says nothing new beyond `threshold` of the largest
/// (Eigen's own, about rounding, where it is 0), none where all are 0.
[[nodiscard]] Eigen::MatrixXd orthonormal_basis(const View& columns, double threshold = 0.0);

/// The same, with each column first scaled to length 1.
[[nodiscard]] Eigen::MatrixXd orthonormal_basis_of_scaled(const View& columns, double threshold = 0.0);

/// Columns that say something new beside those chosen before them, the largest first, of which A'A is `gram`; each is
/// scaled to length 1 first. `threshold`: of what is left of a column, squared. Below about 1e-13 rounding decides.
[[nodiscard]] std::vector<Eigen::Index> independent_columns(const Eigen::MatrixXd& gram, double threshold);

/// min |A x - b| of A'A and A'b. Columns that say nothing new have no part in it.
struct LeastSquares {
  Eigen::VectorXd solution;
  Eigen::MatrixXd unscaled_covariance;  ///< (A'A)^-1; 0 in directions that A does not show
};
[[nodiscard]] LeastSquares least_squares(const Eigen::MatrixXd& gram, const Eigen::VectorXd& product);

}  // namespace sealwatch::dense
