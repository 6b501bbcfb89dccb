// LU factorisation of a small dense matrix with partial pivoting, and the solution for many right-hand sides at once.
//
//   P M = L U;  X <- M^-1 X, where X is n x m, stored row by row, so that every operation runs over whole rows.
//
// The size is a template's argument, or kDynamicSize where it is known at run time only (it may be 0 then).
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

/// Vectors and matrices of N rows, on the stack where N is known.
template <int N>
struct SquareSystem {
  using Vector = std::array<double, N>;
  using Matrix = std::array<std::array<double, N>, N>;
  [[nodiscard]] static Vector vector(int) { return {}; }
  [[nodiscard]] static Matrix matrix(int) { return {}; }
};
template <>
struct SquareSystem<kDynamicSize> {
  using Vector = std::vector<double>;
  using Matrix = DynamicMatrix;
  [[nodiscard]] static Vector vector(int rows) { return Vector(static_cast<std::size_t>(rows), 0.0); }
  [[nodiscard]] static Matrix matrix(int rows) { return Matrix(rows); }
};

template <int N>
class LuFactorisation {
 public:
  using Matrix = typename SquareSystem<N>::Matrix;

  /// False when the matrix is singular or not finite.
  [[nodiscard]] bool factorise(const Matrix& matrix) {
    lu_ = matrix;
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
  void solve(double* x, int columns, std::size_t stride) const {
    for (int row = 0; row < size(); ++row)
      if (pivot_[row] != row) std::swap_ranges(x + row * stride, x + row * stride + columns, x + pivot_[row] * stride);
    for (int row = 1; row < size(); ++row)
      for (int k = 0; k < row; ++k) subtract(x + row * stride, lu_[row][k], x + k * stride, columns);
    for (int row = size() - 1; row >= 0; --row) {
      for (int k = row + 1; k < size(); ++k) subtract(x + row * stride, lu_[row][k], x + k * stride, columns);
      for (int j = 0; j < columns; ++j) x[row * stride + j] *= inverse_diagonal_[row];
    }
  }

 private:
  [[nodiscard]] int size() const {
    if constexpr (N == kDynamicSize)
      return static_cast<int>(lu_.size());
    else
      return N;
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

  static void subtract(double* target, double factor, const double* source, int columns) {
    if (factor == 0.0) return;
    for (int j = 0; j < columns; ++j) target[j] -= factor * source[j];
  }

  using Pivots = std::conditional_t<N == kDynamicSize, std::vector<int>, std::array<int, N == kDynamicSize ? 1 : N>>;
  Matrix lu_{};
  Pivots pivot_{};
  typename SquareSystem<N>::Vector inverse_diagonal_{};
};

}  // namespace sealwatch
