#include "services/common/dense/row_products.hpp"

#include <gtest/gtest.h>

#include <random>

namespace sealwatch::dense {
namespace {

Eigen::MatrixXd random_rows(Eigen::Index rows, Eigen::Index columns) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

void add(RowBlock& block, const Eigen::MatrixXd& rows) {
  for (Eigen::Index k = 0; k < rows.rows(); ++k) {
    const Eigen::RowVectorXd row = rows.row(k);
    block.add(row.data());
  }
}

// Entry by entry in the order of the rows: the same number, not nearly the same.
TEST(RowBlock, SumsProductsInTheOrderOfTheRows) {
  for (const Eigen::Index columns : {1, 7, 8, 29}) {
    const Eigen::MatrixXd rows = random_rows(37, columns);
    RowBlock block(columns, 64);
    add(block, rows);
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(columns, columns);
    block.add_gram_to(gram);
    for (Eigen::Index i = 0; i < columns; ++i)
      for (Eigen::Index j = 0; j < columns; ++j) {
        volatile double sum = 0.0;
        for (Eigen::Index k = 0; k < rows.rows(); ++k) {
          const volatile double product = rows(k, i) * rows(k, j);
          sum = sum + product;
        }
        EXPECT_EQ(gram(i, j), sum) << columns << ' ' << i << ' ' << j;
      }
  }
}

TEST(RowBlock, AddsBlockAfterBlock) {
  const Eigen::MatrixXd rows = random_rows(21, 11);
  RowBlock block(11, 8);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(11, 11);
  for (Eigen::Index begin = 0; begin < rows.rows(); begin += 8) {
    block.clear();
    add(block, rows.middleRows(begin, std::min<Eigen::Index>(8, rows.rows() - begin)));
    EXPECT_EQ(block.full(), begin + 8 <= rows.rows());
    block.add_gram_to(gram);
  }
  EXPECT_LT((gram - rows.transpose() * rows).cwiseAbs().maxCoeff(), 1e-12);
}

// More rows than a block takes, of a matrix and of some of its columns.
TEST(RowProducts, AreThoseOfTheMatrices) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const RowMajor all = random_rows(301, 23);
  const auto x = all.leftCols(9), y = all.rightCols(13);
  EXPECT_LT((gram_of_rows(all) - all.transpose() * all).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT((gram_of_rows(x) - x.transpose() * x).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT((product_of_rows(x, y) - x.transpose() * y).cwiseAbs().maxCoeff(), 1e-11);
}

// The column beside lies in the last panel, in one of its own behind full ones, or alone.
TEST(RowProducts, TakesAColumnThatLiesApart) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  for (const Eigen::Index columns : {0, 5, 7, 8, 19}) {
    const RowMajor all = random_rows(301, columns + 4);
    const Eigen::VectorXd beside = all.col(columns);
    const auto x = all.leftCols(columns), whole = all.leftCols(columns + 1), y = all.rightCols(3);
    const ProductsBeside products = products_beside(x, beside, y);
    EXPECT_LT((products.gram - whole.transpose() * whole).cwiseAbs().maxCoeff(), 1e-11);
    EXPECT_LT((products.with_other - whole.transpose() * y).cwiseAbs().maxCoeff(), 1e-11);
  }
}

TEST(RowProducts, OfNoRowsOrColumnsAreZeroOrEmpty) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  EXPECT_EQ(gram_of_rows(RowMajor(0, 3)), Eigen::MatrixXd::Zero(3, 3));
  EXPECT_EQ(product_of_rows(RowMajor(5, 0), RowMajor(5, 2)).size(), 0);
}

}  // namespace
}  // namespace sealwatch::dense
