// Small least-squares problems of the screening, scaled so that columns of any size go together.
#pragma once

#include <vector>

#include "sealwatch/model/simulation.hpp"
#include "services/common/dense/dense.hpp"
#include "services/common/dense/row_products.hpp"

namespace sealwatch::mismatch {

/// Added to a normal matrix with unit diagonal: directions that the data do not show.
inline constexpr double kRidge = 1e-10;

// (X'X)^-1, of columns of any size; directions that X does not show give nothing.
class NormalMatrix {
 public:
  explicit NormalMatrix(const Eigen::MatrixXd& gram)
      : scale_(gram.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse()) {
    Eigen::MatrixXd scaled = dense::scaled(gram, scale_);
    scaled.diagonal().array() += kRidge;
    factor_ = dense::Symmetric(scaled);
  }
  [[nodiscard]] Eigen::MatrixXd solve(const dense::View& right) const {
    return scale_.asDiagonal() * factor_.solve_columns(scale_.asDiagonal() * right);
  }

 private:
  Eigen::VectorXd scale_;
  dense::Symmetric factor_;
};

// X (X'X)^-1 X'Y taken off Y, in place.
class Projection {
 public:
  explicit Projection(const RowMatrix& x) : x_(x), normal_(dense::gram_of_rows(x)) {}
  template <class Y>
  void remove_from(Y& y) const {
    if (x_.cols() == 0) return;
    const Eigen::MatrixXd share = normal_.solve(dense::product_of_rows(x_, y));
    dense::subtract_product(y.transpose(), share.transpose(), x_.transpose());
  }

 private:
  const RowMatrix& x_;
  NormalMatrix normal_;
};

struct LinearStep {
  Eigen::VectorXd strength;
  double gain = 0.0;
  bool free = true;  ///< no bound was in the way
};

/// max over strengths of 2 g'k - k'G k, those with a lower bound of 0 kept at or above it.
[[nodiscard]] LinearStep bounded_step(const Eigen::MatrixXd& gram, const Eigen::VectorXd& gradient,
                                      const std::vector<bool>& positive);

/// v' M^-1 v
[[nodiscard]] double quadratic(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& vector);

[[nodiscard]] Eigen::MatrixXd submatrix(const Eigen::MatrixXd& matrix, const std::vector<Eigen::Index>& at);
[[nodiscard]] Eigen::VectorXd subvector(const Eigen::VectorXd& vector, const std::vector<Eigen::Index>& at);

}  // namespace sealwatch::mismatch
