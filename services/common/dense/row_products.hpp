// Products of matrices with many rows and few columns, X'Y = sum over rows of x_r' y_r: where fits and screenings spend
// their time.
//
// Each entry is summed over the rows in their order, by products and sums of their own: the result is the same on any
// processor, with wide vectors or without.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace sealwatch::dense {

/// Rows one after another in memory, or some of their columns.
using Rows = Eigen::Ref<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

/// X'X
[[nodiscard]] Eigen::MatrixXd gram_of_rows(const Rows& x);
/// X'Y of as many rows
[[nodiscard]] Eigen::MatrixXd product_of_rows(const Rows& x, const Rows& y);
/// [X r]'[X r] and [X r]'Y, with one look at the rows
struct ProductsBeside {
  Eigen::MatrixXd gram, with_other;
};
[[nodiscard]] ProductsBeside products_beside(const Rows& x, const Eigen::VectorXd& r, const Rows& y);

/// Rows are filled in one by one; `gram` is then their C'C.
class RowBlock {
 public:
  /// `rows`: at most so many.
  RowBlock(Eigen::Index columns, Eigen::Index rows);

  void clear() { rows_ = 0; }
  [[nodiscard]] bool full() const { return rows_ == most_; }
  /// The next row's `columns` values.
  void add(const double* row);
  /// The same, the last value apart.
  void add(const double* row, double last);
  /// C'C, all of it, added to `gram`.
  void add_gram_to(Eigen::MatrixXd& gram) const;
  /// C'D, all of it, added to `product`; as many rows in both.
  void add_product_to(const RowBlock& other, Eigen::MatrixXd& product) const;

 private:
  void copy(const double* row, Eigen::Index count);
  [[nodiscard]] const double* panel(Eigen::Index which) const;

  Eigen::Index columns_, panels_, most_, rows_ = 0;
  std::vector<double> panels_of_rows_;  ///< kPanel columns at a time, row by row
};

}  // namespace sealwatch::dense
