// X'X of the derivatives of one recording (31 s at 200 Hz, 7 channels, 40 unknowns): by dense::gram_of_rows and by
// Eigen's general product, in turns. Prints the least time of each; fails where the first is not twice as fast.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <random>

#include "services/common/dense/row_products.hpp"

int main() {
  using namespace sealwatch;
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  constexpr int kTurns = 15;
  constexpr double kGoal = 2.0;
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const RowMajor rows = RowMajor::NullaryExpr(43400, 40, [&] { return normal(random); });
  Eigen::MatrixXd by_rows, by_eigen;
  const auto seconds = [](const auto& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  double own = 1e9, general = 1e9;
  for (int turn = 0; turn < kTurns; ++turn) {
    own = std::min(own, seconds([&] { by_rows = dense::gram_of_rows(rows); }));
    general = std::min(general, seconds([&] { by_eigen.noalias() = rows.transpose() * rows; }));
  }
  std::printf("X'X, 43400 x 40: %.2f ms, Eigen's product %.2f ms: %.1f times faster (goal %.0f)\n", 1e3 * own,
              1e3 * general, general / own, kGoal);
  return general >= kGoal * own && (by_rows - by_eigen).norm() < 1e-9 * by_eigen.norm() ? 0 : 1;
}
