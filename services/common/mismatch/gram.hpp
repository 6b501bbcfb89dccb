// Sums of products of a block of rows, C'C for C with rows r_1, r_2, ...: where the screening spends its time.
//
// Each entry is summed over the rows in their order, by products and sums of their own: the result is the same on any
// processor, with wide vectors or without.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace sealwatch::mismatch {

/// Rows are filled in one by one; `gram` is then their C'C.
class RowBlock {
 public:
  /// `rows`: at most so many.
  RowBlock(Eigen::Index columns, Eigen::Index rows);

  void clear() { rows_ = 0; }
  [[nodiscard]] bool full() const { return rows_ == most_; }
  /// The next row's `columns` values.
  void add(const double* row);
  /// C'C, all of it, added to `gram`.
  void add_gram_to(Eigen::MatrixXd& gram) const;

 private:
  Eigen::Index columns_, panels_, most_, rows_ = 0;
  std::vector<double> panels_of_rows_;  ///< kPanel columns at a time, row by row
};

}  // namespace sealwatch::mismatch
