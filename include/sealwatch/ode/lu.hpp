// LU factorisation of a small dense matrix with partial pivoting, and the solution for many right-hand sides at once.
//
//   P M = L U;  X <- M^-1 X, where X is n x m, stored row by row, so that every operation runs over whole rows.
//
// The size is a template's argument. Where it is known at run time only (it may be 0 then), that is kDynamicSize, or
// at_most(n), which needs no memory of its own.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace sealwatch {

inline constexpr int kDynamicSize = -1;
[[nodiscard]] constexpr int at_most(int size) { return -1 - size; }

/// A square matrix whose size is known at run time only: m[row][column].
class DynamicMatrix {
 public:
  DynamicMatrix() = default;
  explicit DynamicMatrix(int size) : size_(static_cast<std::size_t>(size)), values_(size_ * size_, 0.0) {}
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::span<double> operator[](std::size_t row) { return {values_.data() + row * size_, size_}; }
  [[nodiscard]] std::span<const double> operator[](std::size_t row) const {
    return {values_.data() + row * size_, size_};
  }

 private:
  std::size_t size_ = 0;
  std::vector<double> values_;
};

/// Vectors and matrices of N rows, on the stack where N is known or has a largest value.
template <int N>
struct SquareSystem {
  static constexpr int kMost = N < 0 ? -1 - N : N;
  using Vector = std::array<double, kMost>;
  using Matrix = std::array<std::array<double, kMost>, kMost>;
  using Pivots = std::array<int, kMost>;
  [[nodiscard]] static Vector vector(int) { return {}; }
  [[nodiscard]] static Matrix matrix(int) { return {}; }
};
template <>
struct SquareSystem<kDynamicSize> {
  using Vector = std::vector<double>;
  using Matrix = DynamicMatrix;
  using Pivots = std::vector<int>;
  [[nodiscard]] static Vector vector(int rows) { return Vector(static_cast<std::size_t>(rows), 0.0); }
  [[nodiscard]] static Matrix matrix(int rows) { return Matrix(rows); }
};

/// L and U in one matrix, row by row, as LuFactorisation makes them.
struct LuFactors {
  const double* lu;
  const int* pivot;  ///< row that each column's pivot came from
  const double* inverse_diagonal;
  int size;
  int row_length;  ///< of lu in memory
};
/// X <- M^-1 X, some columns at a time.
void solve_columns(const LuFactors& of, double* x, std::size_t columns, std::size_t stride);

template <int N>
class LuFactorisation {
 public:
  using Matrix = typename SquareSystem<N>::Matrix;

  /// False when the matrix is singular or not finite.
  [[nodiscard]] bool factorise(const Matrix& matrix) requires(N >= 0) { return factorise(matrix, N); }
  /// `size_at_run_time`: rows, where N does not say it.
  [[nodiscard]] bool factorise(const Matrix& matrix, int size_at_run_time) {
    lu_ = matrix;
    size_ = size_at_run_time;
    if constexpr (N == kDynamicSize) {
      pivot_.resize(lu_.size());
      inverse_diagonal_.resize(lu_.size());
    }
    for (int column = 0; column < size(); ++column) {
      const int pivot = largest_row(column);
      pivot_[column] = pivot;
      if (pivot != column) swap_rows(pivot, column);
      if (!(std::abs(lu_[column][column]) > 0.0) || !std::isfinite(lu_[column][column])) return false;
      eliminate(column);
    }
    return true;
  }

  /// X <- M^-1 X for `columns` right-hand sides; row r starts at x + r * stride.
  void solve(double* x, std::size_t columns, std::size_t stride) const {
    if (size() == 0) return;
    solve_columns({&lu_[0][0], pivot_.data(), inverse_diagonal_.data(), size(), row_length()}, x, columns, stride);
  }
  /// x <- M^-1 x
  void solve(double* x) const {
    for (int row = 0; row < size(); ++row)
      if (pivot_[row] != row) std::swap(x[row], x[pivot_[row]]);
    for (int row = 1; row < size(); ++row)
      for (int k = 0; k < row; ++k) x[row] -= lu_[row][k] * x[k];
    for (int row = size() - 1; row >= 0; --row) {
      for (int k = row + 1; k < size(); ++k) x[row] -= lu_[row][k] * x[k];
      x[row] *= inverse_diagonal_[row];
    }
  }

 private:
  [[nodiscard]] int size() const {
    if constexpr (N < 0)
      return size_;
    else
      return N;
  }
  [[nodiscard]] int row_length() const {
    if constexpr (N == kDynamicSize)
      return size_;
    else
      return SquareSystem<N>::kMost;
  }

  void swap_rows(int a, int b) {
    auto&& first = lu_[a];
    auto&& second = lu_[b];
    std::swap_ranges(first.begin(), first.end(), second.begin());
  }

  [[nodiscard]] int largest_row(int column) const {
    int best = column;
    for (int row = column + 1; row < size(); ++row)
      if (std::abs(lu_[row][column]) > std::abs(lu_[best][column])) best = row;
    return best;
  }

  void eliminate(int column) {
    inverse_diagonal_[column] = 1.0 / lu_[column][column];
    for (int row = column + 1; row < size(); ++row) {
      if (lu_[row][column] == 0.0) continue;  // balances couple few states: most entries are zero
      const double factor = lu_[row][column] * inverse_diagonal_[column];
      lu_[row][column] = factor;
      for (int k = column + 1; k < size(); ++k) lu_[row][k] -= factor * lu_[column][k];
    }
  }

  Matrix lu_{};
  typename SquareSystem<N>::Pivots pivot_{};
  int size_ = 0;
  typename SquareSystem<N>::Vector inverse_diagonal_{};
};

}  // namespace sealwatch
