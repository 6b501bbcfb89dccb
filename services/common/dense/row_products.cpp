#include "services/common/dense/row_products.hpp"

#include <algorithm>
#include <cstring>

namespace sealwatch::dense {
namespace {

constexpr Eigen::Index kPanel = 8;  // columns side by side: one of the widest vectors used here

// Where processors have vectors of four or eight doubles, the same sums are done so many at a time (CMakeLists.txt keeps
// products and sums apart, which would be rounded once where they are one operation).
#if defined(__x86_64__) && defined(__GNUC__)
#define SEALWATCH_CHOOSES_VECTORS 1
#endif

// a'b of two panels' columns, `Rows` columns of a by all of b, `Width` at a time: what fits a processor's registers.
// Vectors are copied one by one: an array of them, copied at once, would stay in memory.
template <int Rows, int Width>
[[gnu::always_inline]] inline void panel_product(const double* a, const double* b, Eigen::Index rows, double* sums) {
  using Vector [[gnu::vector_size(Width * sizeof(double))]] = double;
  constexpr Eigen::Index kVectors = kPanel / Width;
  for (int first = 0; first < kPanel; first += Rows) {
    Vector sum[Rows][kVectors] = {};
    const double *left = a + first, *right = b;
    for (Eigen::Index row = 0; row < rows; ++row, left += kPanel, right += kPanel)
#pragma GCC unroll 8
      for (Eigen::Index v = 0; v < kVectors; ++v) {
        Vector of_right;
        __builtin_memcpy(&of_right, right + v * Width, sizeof(of_right));
#pragma GCC unroll 8
        for (int i = 0; i < Rows; ++i) sum[i][v] += left[i] * of_right;
      }
#pragma GCC unroll 8
    for (int i = 0; i < Rows; ++i)
#pragma GCC unroll 8
      for (Eigen::Index v = 0; v < kVectors; ++v)
        __builtin_memcpy(sums + (first + i) * kPanel + v * Width, &sum[i][v], sizeof(Vector));
  }
}

void product_by_two(const double* a, const double* b, Eigen::Index rows, double* sums) {
  panel_product<2, 2>(a, b, rows, sums);
}

#ifdef SEALWATCH_CHOOSES_VECTORS
[[gnu::target("avx2")]] void product_by_four(const double* a, const double* b, Eigen::Index rows, double* sums) {
  panel_product<4, 4>(a, b, rows, sums);
}
[[gnu::target("avx512f")]] void product_by_eight(const double* a, const double* b, Eigen::Index rows, double* sums) {
  panel_product<8, 8>(a, b, rows, sums);
}
#endif

using Product = void (*)(const double*, const double*, Eigen::Index, double*);

Product fastest_product() {
#ifdef SEALWATCH_CHOOSES_VECTORS
  if (__builtin_cpu_supports("avx512f")) return product_by_eight;
  if (__builtin_cpu_supports("avx2")) return product_by_four;
#endif
  return product_by_two;
}

const Product product_of_panels = fastest_product();

constexpr Eigen::Index kAtOnce = 128;  // rows: their panels stay in the nearest cache

void fill(RowBlock& block, const Rows& x, Eigen::Index begin) {
  block.clear();
  const Eigen::Index end = std::min(begin + kAtOnce, x.rows());
  for (Eigen::Index row = begin; row < end; ++row) block.add(x.data() + row * x.outerStride());
}

void fill(RowBlock& block, const Rows& x, const Eigen::VectorXd& last, Eigen::Index begin) {
  block.clear();
  const Eigen::Index end = std::min(begin + kAtOnce, x.rows());
  for (Eigen::Index row = begin; row < end; ++row) block.add(x.data() + row * x.outerStride(), last(row));
}

}  // namespace

RowBlock::RowBlock(Eigen::Index columns, Eigen::Index rows)
    : columns_(columns),
      panels_((columns + kPanel - 1) / kPanel),
      most_(rows),
      panels_of_rows_(static_cast<std::size_t>(panels_ * kPanel * rows), 0.0) {}

void RowBlock::copy(const double* row, Eigen::Index count) {
  double* place = panels_of_rows_.data() + rows_ * kPanel;
  Eigen::Index first = 0;
  for (; first + kPanel <= count; first += kPanel, place += most_ * kPanel)
    std::memcpy(place, row + first, kPanel * sizeof(double));
  std::copy_n(row + first, count - first, place);
}

void RowBlock::add(const double* row) {
  copy(row, columns_);
  ++rows_;
}

void RowBlock::add(const double* row, double last) {
  const Eigen::Index column = columns_ - 1;
  copy(row, column);
  panels_of_rows_[static_cast<std::size_t>((column / kPanel * most_ + rows_) * kPanel + column % kPanel)] = last;
  ++rows_;
}

const double* RowBlock::panel(Eigen::Index which) const { return panels_of_rows_.data() + which * most_ * kPanel; }

void RowBlock::add_gram_to(Eigen::MatrixXd& gram) const {
  double sums[kPanel * kPanel];
  for (Eigen::Index p = 0; p < panels_; ++p)
    for (Eigen::Index q = 0; q <= p; ++q) {
      product_of_panels(panel(p), panel(q), rows_, sums);
      for (Eigen::Index i = p * kPanel; i < std::min((p + 1) * kPanel, columns_); ++i)
        for (Eigen::Index j = q * kPanel; j < std::min((q + 1) * kPanel, i + 1); ++j) {
          const double sum = sums[(i - p * kPanel) * kPanel + j - q * kPanel];
          gram(i, j) += sum;
          if (i != j) gram(j, i) += sum;
        }
    }
}

void RowBlock::add_product_to(const RowBlock& other, Eigen::MatrixXd& product) const {
  double sums[kPanel * kPanel];
  for (Eigen::Index p = 0; p < panels_; ++p)
    for (Eigen::Index q = 0; q < other.panels_; ++q) {
      product_of_panels(panel(p), other.panel(q), rows_, sums);
      for (Eigen::Index i = p * kPanel; i < std::min((p + 1) * kPanel, columns_); ++i)
        for (Eigen::Index j = q * kPanel; j < std::min((q + 1) * kPanel, other.columns_); ++j)
          product(i, j) += sums[(i - p * kPanel) * kPanel + j - q * kPanel];
    }
}

Eigen::MatrixXd gram_of_rows(const Rows& x) {
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(x.cols(), x.cols());
  if (gram.size() == 0) return gram;
  RowBlock block(x.cols(), kAtOnce);
  for (Eigen::Index begin = 0; begin < x.rows(); begin += kAtOnce) {
    fill(block, x, begin);
    block.add_gram_to(gram);
  }
  return gram;
}

ProductsBeside products_beside(const Rows& x, const Eigen::VectorXd& r, const Rows& y) {
  const Eigen::Index columns = x.cols() + 1;
  ProductsBeside products{.gram = Eigen::MatrixXd::Zero(columns, columns),
                          .with_other = Eigen::MatrixXd::Zero(columns, y.cols())};
  RowBlock left(columns, kAtOnce), right(y.cols(), kAtOnce);
  for (Eigen::Index begin = 0; begin < x.rows(); begin += kAtOnce) {
    fill(left, x, r, begin);
    left.add_gram_to(products.gram);
    fill(right, y, begin);
    left.add_product_to(right, products.with_other);
  }
  return products;
}

Eigen::MatrixXd product_of_rows(const Rows& x, const Rows& y) {
  Eigen::MatrixXd product = Eigen::MatrixXd::Zero(x.cols(), y.cols());
  if (product.size() == 0) return product;
  RowBlock left(x.cols(), kAtOnce), right(y.cols(), kAtOnce);
  for (Eigen::Index begin = 0; begin < x.rows(); begin += kAtOnce) {
    fill(left, x, begin);
    fill(right, y, begin);
    left.add_product_to(right, product);
  }
  return product;
}

}  // namespace sealwatch::dense
