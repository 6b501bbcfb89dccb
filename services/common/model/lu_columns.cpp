#include <algorithm>
#include <cstddef>
#include <cstring>

#include "sealwatch/core/wide_vectors.hpp"
#include "sealwatch/ode/lu.hpp"

namespace sealwatch {
namespace {

const double* row_of(const LuFactors& of, int row) {
  return of.lu + static_cast<std::ptrdiff_t>(row) * static_cast<std::ptrdiff_t>(of.row_length);
}

// Row `row` of x less lu(row, k) times row k, from k = begin to end. 4 * `Wide` columns, which stay in registers. Balances
// couple few states: most factors are 0.
template <std::size_t Wide>
[[gnu::always_inline]] inline void subtract_rows(const double* factors, int row, int begin, int end, double by,
                                                 double* x, std::size_t stride) {
  WideVector sum[Wide], other;
  double* target = x + static_cast<std::size_t>(row) * stride;
#pragma GCC unroll 4
  for (std::size_t v = 0; v < Wide; ++v) std::memcpy(&sum[v], target + v * kWidth, sizeof(other));
  for (int k = begin; k < end; ++k) {
    if (factors[k] == 0.0) continue;
    const double* from = x + static_cast<std::size_t>(k) * stride;
#pragma GCC unroll 4
    for (std::size_t v = 0; v < Wide; ++v) {
      std::memcpy(&other, from + v * kWidth, sizeof(other));
      sum[v] -= factors[k] * other;
    }
  }
#pragma GCC unroll 4
  for (std::size_t v = 0; v < Wide; ++v) {
    sum[v] *= by;
    std::memcpy(target + v * kWidth, &sum[v], sizeof(other));
  }
}

template <std::size_t Wide>
[[gnu::always_inline]] inline void solve_together(const LuFactors& of, double* x, std::size_t stride) {
  for (int row = 1; row < of.size; ++row) subtract_rows<Wide>(row_of(of, row), row, 0, row, 1.0, x, stride);
  for (int row = of.size - 1; row >= 0; --row)
    subtract_rows<Wide>(row_of(of, row), row, row + 1, of.size, of.inverse_diagonal[row], x, stride);
}

void solve_one(const LuFactors& of, double* x, std::size_t stride) {
  const auto at = [&](int row) -> double& { return x[static_cast<std::size_t>(row) * stride]; };
  for (int row = 1; row < of.size; ++row)
    for (int k = 0; k < row; ++k) at(row) -= row_of(of, row)[k] * at(k);
  for (int row = of.size - 1; row >= 0; --row) {
    for (int k = row + 1; k < of.size; ++k) at(row) -= row_of(of, row)[k] * at(k);
    at(row) *= of.inverse_diagonal[row];
  }
}

SEALWATCH_WIDE_VECTORS
void solve_wide(const LuFactors& of, double* x, std::size_t columns, std::size_t stride) {
  constexpr std::size_t kMost = 4;
  std::size_t first = 0;
  for (; first + kMost * kWidth <= columns; first += kMost * kWidth) solve_together<kMost>(of, x + first, stride);
  for (; first + kWidth <= columns; first += kWidth) solve_together<1>(of, x + first, stride);
}

}  // namespace

void solve_columns(const LuFactors& of, double* x, std::size_t columns, std::size_t stride) {
  for (int row = 0; row < of.size; ++row)
    if (of.pivot[row] != row) {
      double* from = x + static_cast<std::size_t>(row) * stride;
      std::swap_ranges(from, from + columns, x + static_cast<std::size_t>(of.pivot[row]) * stride);
    }
  solve_wide(of, x, columns, stride);
  for (std::size_t first = columns / kWidth * kWidth; first < columns; ++first) solve_one(of, x + first, stride);
}

}  // namespace sealwatch
