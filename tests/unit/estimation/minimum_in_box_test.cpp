// The minimum of a quadratic form within ranges, against conditions that define it and against a search by halving.
#include "services/common/estimation/minimum_in_box.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace sealwatch {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kHardly = 1e-8;  // damped

/// Coordinate descent, slow and plain: each entry at its own best within its range, again and again.
Eigen::VectorXd by_descent(const Eigen::MatrixXd& gram, const Eigen::VectorXd& gradient, const Eigen::VectorXd& low,
                           const Eigen::VectorXd& high) {
  Eigen::VectorXd d = Eigen::VectorXd::Zero(gradient.size()).cwiseMax(low).cwiseMin(high);
  for (int round = 0; round < 20000; ++round)
    for (Eigen::Index k = 0; k < d.size(); ++k) {
      const double slope = gram.row(k).dot(d) + gradient(k);
      d(k) = std::clamp(d(k) - slope / gram(k, k), low(k), high(k));
    }
  return d;
}

TEST(MinimumInBox, IsTheFreeMinimumWhereThatLiesInside) {
  const Eigen::Matrix2d gram{{2.0, 1.0}, {1.0, 3.0}};
  const Eigen::Vector2d gradient{-3.0, -4.0};  // the minimum: (1, 1)
  const Eigen::Vector2d low = Eigen::Vector2d::Constant(-kInfinite), high = -low;
  EXPECT_LT((minimum_in_box(gram, gradient, low, high, kHardly) - Eigen::Vector2d(1.0, 1.0)).norm(), 1e-7);
}

TEST(MinimumInBox, HoldsAnEntryAtItsEndAndMovesTheOthers) {
  const Eigen::Matrix2d gram{{2.0, 1.0}, {1.0, 3.0}};
  const Eigen::Vector2d gradient{-3.0, -4.0};
  const Eigen::Vector2d low{-kInfinite, -kInfinite}, high{0.5, kInfinite};
  const Eigen::VectorXd d = minimum_in_box(gram, gradient, low, high, kHardly);
  EXPECT_DOUBLE_EQ(d(0), 0.5);
  EXPECT_NEAR(d(1), (4.0 - 0.5) / 3.0, 1e-7) << "(3 - 1 = 2 would be its best beside 1)";
}

TEST(MinimumInBox, LetsGoOfWhatItHeldOnTheWay) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> width(0.0, 1.0);
  for (int set = 0; set < 200; ++set) {
    const Eigen::Index n = 1 + set % 7;
    const Eigen::MatrixXd root = Eigen::MatrixXd::NullaryExpr(n + 3, n, [&] { return normal(random); });
    const Eigen::MatrixXd gram = root.transpose() * root;
    const Eigen::VectorXd gradient = Eigen::VectorXd::NullaryExpr(n, [&] { return 5.0 * normal(random); });
    const Eigen::VectorXd low = Eigen::VectorXd::NullaryExpr(n, [&] { return -width(random); }),
                          high =
                              Eigen::VectorXd::NullaryExpr(n, [&] { return set % 3 == 0 ? kInfinite : width(random); });
    const Eigen::VectorXd d = minimum_in_box(gram, gradient, low, high, kHardly),
                          slow = by_descent(gram, gradient, low, high);
    EXPECT_LT((d - slow).norm(), 1e-5 * (1.0 + slow.norm())) << set;
    EXPECT_TRUE((d.array() >= low.array() - 1e-12).all() && (d.array() <= high.array() + 1e-12).all()) << set;
  }
}

TEST(MinimumInBox, DoesNotRunAwayWhereTheFormIsFlat) {
  const Eigen::Matrix2d gram{{1.0, 1.0}, {1.0, 1.0}};  // only the sum is known
  const Eigen::Vector2d gradient{-1.0, -1.0};
  const Eigen::Vector2d low = Eigen::Vector2d::Constant(-kInfinite), high = -low;
  const Eigen::VectorXd d = minimum_in_box(gram, gradient, low, high, kHardly);
  EXPECT_NEAR(d.sum(), 1.0, 1e-6);
  EXPECT_LT(d.norm(), 2.0);
}

}  // namespace
}  // namespace sealwatch
