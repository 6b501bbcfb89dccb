#include "services/common/estimation/minimum_in_box.hpp"

#include <vector>

#include "services/common/dense/dense.hpp"

namespace sealwatch {
namespace {

constexpr double kWorth = 1e-9;  // slope, of the largest at the start, for which an entry leaves the end of its range
constexpr Eigen::Index kTurns = 10;  // for each entry

// Of the free entries, the others held where they are.
Eigen::VectorXd free_minimum(const Eigen::MatrixXd& gram, const Eigen::VectorXd& gradient, const Eigen::VectorXd& d,
                             const std::vector<bool>& held) {
  std::vector<Eigen::Index> free;
  Eigen::VectorXd rest = d;
  for (Eigen::Index k = 0; k < d.size(); ++k) {
    if (held[static_cast<std::size_t>(k)]) continue;
    free.push_back(k);
    rest(k) = 0.0;
  }
  Eigen::VectorXd target = rest;
  if (free.empty()) return target;
  const Eigen::VectorXd right = -(gradient + gram * rest);
  const Eigen::VectorXd solution = dense::Symmetric(gram(free, free)).solve(Eigen::VectorXd(right(free)));
  for (std::size_t k = 0; k < free.size(); ++k) target(free[k]) = solution(static_cast<Eigen::Index>(k));
  return target;
}

// Entry that first meets the end of its range on the way from d to the target, which is moved back to there; -1: none.
Eigen::Index first_blocked(const Eigen::VectorXd& d, Eigen::VectorXd& target, const Eigen::VectorXd& low,
                           const Eigen::VectorXd& high) {
  Eigen::Index blocked = -1;
  double share = 1.0;
  for (Eigen::Index k = 0; k < d.size(); ++k) {
    const double end = target(k) < low(k) ? low(k) : high(k);
    if (target(k) >= low(k) && target(k) <= high(k)) continue;
    const double way = (end - d(k)) / (target(k) - d(k));
    if (blocked < 0 || way < share) blocked = k, share = way;
  }
  if (blocked < 0) return blocked;
  const double end = target(blocked) < low(blocked) ? low(blocked) : high(blocked);
  target = d + share * (target - d);
  target(blocked) = end;
  return blocked;
}

}  // namespace

Eigen::VectorXd minimum_in_box(const Eigen::MatrixXd& gram, const Eigen::VectorXd& gradient, const Eigen::VectorXd& low,
                               const Eigen::VectorXd& high, double damping) {
  const Eigen::Index n = gradient.size();
  const Eigen::VectorXd scale = gram.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const auto shrink = scale.cwiseInverse().asDiagonal();
  Eigen::MatrixXd g = shrink * gram * shrink;
  g.diagonal().array() += damping;
  const Eigen::VectorXd slope = shrink * gradient, least = scale.cwiseProduct(low), most = scale.cwiseProduct(high);
  Eigen::VectorXd d = Eigen::VectorXd::Zero(n).cwiseMax(least).cwiseMin(most);
  std::vector<bool> held(static_cast<std::size_t>(n), false);
  const double worth = kWorth * slope.cwiseAbs().maxCoeff();
  for (Eigen::Index turn = 0; turn < kTurns * n; ++turn) {
    Eigen::VectorXd target = free_minimum(g, slope, d, held);
    const Eigen::Index blocked = first_blocked(d, target, least, most);
    d = target;
    if (blocked >= 0) {
      held[static_cast<std::size_t>(blocked)] = true;
      continue;
    }
    const Eigen::VectorXd here = g * d + slope;
    Eigen::Index leaves = -1;
    for (Eigen::Index k = 0; k < n; ++k) {
      if (!held[static_cast<std::size_t>(k)] || !(most(k) > least(k))) continue;
      const double inwards = d(k) <= least(k) ? -here(k) : here(k);
      if (inwards > worth && (leaves < 0 || inwards > std::abs(here(leaves)))) leaves = k;
    }
    if (leaves < 0) break;
    held[static_cast<std::size_t>(leaves)] = false;
  }
  return shrink * d;
}

}  // namespace sealwatch
