#include "services/common/mismatch/gram.hpp"

#include <algorithm>

namespace sealwatch::mismatch {
namespace {

constexpr Eigen::Index kPanel = 8;  // columns side by side: two of the widest vectors used here

// Where processors have vectors of four doubles, the same sums are done four at a time.
#if defined(__x86_64__) && defined(__GNUC__)
#define SEALWATCH_WIDE_VECTORS 1
#endif

// a'b of two panels' columns, four columns of a by `Width` of b: what fits the registers of such a processor.
template <int Width>
[[gnu::always_inline]] inline void tile(const double* a, const double* b, Eigen::Index rows, double* sums) {
  using Four [[gnu::vector_size(32)]] = double;
  constexpr int kFours = Width / 4;
  Four sum[4][kFours] = {};
  for (Eigen::Index row = 0; row < rows; ++row, a += kPanel, b += kPanel) {
    Four right[kFours];
    for (int v = 0; v < kFours; ++v) __builtin_memcpy(&right[v], b + 4 * v, sizeof(Four));
    for (int i = 0; i < 4; ++i)
      for (int v = 0; v < kFours; ++v) sum[i][v] += a[i] * right[v];
  }
  for (int i = 0; i < 4; ++i)
    for (int v = 0; v < kFours; ++v) __builtin_memcpy(sums + i * kPanel + 4 * v, &sum[i][v], sizeof(Four));
}

template <int Width>
[[gnu::always_inline]] inline void panel_product(const double* a, const double* b, Eigen::Index rows, double* sums) {
  for (int i = 0; i < kPanel; i += 4)
    for (int j = 0; j < kPanel; j += Width) tile<Width>(a + i, b + j, rows, sums + i * kPanel + j);
}

void narrow_product(const double* a, const double* b, Eigen::Index rows, double* sums) {
  panel_product<4>(a, b, rows, sums);
}

#ifdef SEALWATCH_WIDE_VECTORS
[[gnu::target("avx2")]] void wide_product(const double* a, const double* b, Eigen::Index rows, double* sums) {
  panel_product<8>(a, b, rows, sums);
}
#endif

using Product = void (*)(const double*, const double*, Eigen::Index, double*);

Product fastest_product() {
#ifdef SEALWATCH_WIDE_VECTORS
  if (__builtin_cpu_supports("avx2")) return wide_product;
#endif
  return narrow_product;
}

}  // namespace

RowBlock::RowBlock(Eigen::Index columns, Eigen::Index rows)
    : columns_(columns),
      panels_((columns + kPanel - 1) / kPanel),
      most_(rows),
      panels_of_rows_(static_cast<std::size_t>(panels_ * kPanel * rows), 0.0) {}

void RowBlock::add(const double* row) {
  double* place = panels_of_rows_.data() + rows_ * kPanel;
  for (Eigen::Index first = 0; first < columns_; first += kPanel, place += most_ * kPanel)
    std::copy_n(row + first, std::min(kPanel, columns_ - first), place);
  ++rows_;
}

void RowBlock::add_gram_to(Eigen::MatrixXd& gram) const {
  static const Product product = fastest_product();
  double sums[kPanel * kPanel];
  for (Eigen::Index p = 0; p < panels_; ++p)
    for (Eigen::Index q = 0; q <= p; ++q) {
      product(panels_of_rows_.data() + p * most_ * kPanel, panels_of_rows_.data() + q * most_ * kPanel, rows_, sums);
      for (Eigen::Index i = p * kPanel; i < std::min((p + 1) * kPanel, columns_); ++i)
        for (Eigen::Index j = q * kPanel; j < std::min((q + 1) * kPanel, i + 1); ++j) {
          const double sum = sums[(i - p * kPanel) * kPanel + j - q * kPanel];
          gram(i, j) += sum;
          if (i != j) gram(j, i) += sum;
        }
    }
}

}  // namespace sealwatch::mismatch
