// LU factorisation of a small dense matrix with partial pivoting, and the solution for many right-hand sides at once.
//
//   P M = L U;  X <- M^-1 X, where X is n x m, stored row by row, so that every operation runs over whole rows.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace sealwatch {

template <int N>
class LuFactorisation {
 public:
  using Matrix = std::array<std::array<double, N>, N>;

  /// False when the matrix is singular or not finite.
  [[nodiscard]] bool factorise(const Matrix& matrix) {
    lu_ = matrix;
    for (int column = 0; column < N; ++column) {
      const int pivot = largest_row(column);
      pivot_[column] = pivot;
      if (pivot != column) std::swap(lu_[pivot], lu_[column]);
      if (!(std::abs(lu_[column][column]) > 0.0) || !std::isfinite(lu_[column][column])) return false;
      eliminate(column);
    }
    return true;
  }

  /// X <- M^-1 X for `columns` right-hand sides; row r starts at x + r * stride.
  void solve(double* x, int columns, std::size_t stride) const {
    for (int row = 0; row < N; ++row)
      if (pivot_[row] != row) std::swap_ranges(x + row * stride, x + row * stride + columns, x + pivot_[row] * stride);
    for (int row = 1; row < N; ++row)
      for (int k = 0; k < row; ++k) subtract(x + row * stride, lu_[row][k], x + k * stride, columns);
    for (int row = N - 1; row >= 0; --row) {
      for (int k = row + 1; k < N; ++k) subtract(x + row * stride, lu_[row][k], x + k * stride, columns);
      for (int j = 0; j < columns; ++j) x[row * stride + j] *= inverse_diagonal_[row];
    }
  }

 private:
  [[nodiscard]] int largest_row(int column) const {
    int best = column;
    for (int row = column + 1; row < N; ++row)
      if (std::abs(lu_[row][column]) > std::abs(lu_[best][column])) best = row;
    return best;
  }

  void eliminate(int column) {
    inverse_diagonal_[column] = 1.0 / lu_[column][column];
    for (int row = column + 1; row < N; ++row) {
      if (lu_[row][column] == 0.0) continue;  // balances couple few states: most entries are zero
      const double factor = lu_[row][column] * inverse_diagonal_[column];
      lu_[row][column] = factor;
      for (int k = column + 1; k < N; ++k) lu_[row][k] -= factor * lu_[column][k];
    }
  }

  static void subtract(double* target, double factor, const double* source, int columns) {
    if (factor == 0.0) return;
    for (int j = 0; j < columns; ++j) target[j] -= factor * source[j];
  }

  Matrix lu_{};
  std::array<int, N> pivot_{};
  std::array<double, N> inverse_diagonal_{};
};

}  // namespace sealwatch
