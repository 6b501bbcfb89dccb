#include "services/common/trace/regimes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sealwatch/signal/statistics.hpp"

namespace sealwatch::trace {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd where(const Eigen::Array<bool, Eigen::Dynamic, 1>& condition) { return condition.cast<double>().matrix(); }

}  // namespace

std::vector<Regime> regimes_of(const VectorXd& velocity) {
  constexpr double kOfTheFastest = 0.05, kReversalShare = 0.01;
  const Index n = velocity.size();
  std::vector<double> speeds(static_cast<std::size_t>(n));
  for (Index t = 0; t < n; ++t) speeds[static_cast<std::size_t>(t)] = std::abs(velocity(t));
  const double least = kOfTheFastest * signal::quantile(speeds, 0.95);
  Eigen::ArrayXi way(n);
  for (Index t = 0; t < n; ++t) way(t) = velocity(t) > least ? 1 : velocity(t) < -least ? -1 : 0;
  const Index near = std::max<Index>(1, static_cast<Index>(kReversalShare * static_cast<double>(n)));
  Eigen::Array<bool, Eigen::Dynamic, 1> reversing = Eigen::Array<bool, Eigen::Dynamic, 1>::Constant(n, false);
  for (Index t = 1; t < n; ++t)
    if (way(t) != way(t - 1)) {
      const Index begin = std::max<Index>(t - near, 0), end = std::min(t + near, n);
      reversing.segment(begin, end - begin) = true;
    }
  return {{"at rest", where(way == 0 && !reversing)},
          {"moving up", where(way == 1 && !reversing)},
          {"moving down", where(way == -1 && !reversing)},
          {"starting, stopping or reversing", where(reversing)}};
}

std::vector<Regime> levels_of(const VectorXd& course) {
  const double low = course.minCoeff(), third = (course.maxCoeff() - low) / 3.0;
  const Eigen::ArrayXd level = course.array() - low;
  return {{"at low values", where(level < third)},
          {"at middle values", where(level >= third && level <= 2.0 * third)},
          {"at high values", where(level > 2.0 * third)}};
}

std::vector<RegimeMisfit> misfit_by_regime(const VectorXd& difference, const std::vector<Regime>& regimes) {
  std::vector<RegimeMisfit> out;
  const double all = difference.squaredNorm();
  for (const Regime& regime : regimes) {
    const double samples = regime.indicator.sum();
    if (samples < 1.0) continue;
    const double squares = (difference.array().square() * regime.indicator.array()).sum();
    out.push_back({regime.name, samples / static_cast<double>(difference.size()), std::sqrt(squares / samples),
                   all > 0.0 ? squares / all : 0.0});
  }
  return out;
}

std::vector<MisfitInterval> misfit_by_time(const std::vector<double>& time_s, const VectorXd& difference) {
  constexpr Index kPieces = 50;
  constexpr std::size_t kMost = 3;
  const Index n = difference.size(), pieces = std::min(kPieces, n);
  const double all = difference.squaredNorm();
  if (!(all > 0.0)) return {};
  std::vector<double> squares(static_cast<std::size_t>(pieces));
  const auto begin_of = [&](Index piece) { return piece * n / pieces; };
  for (Index k = 0; k < pieces; ++k)
    squares[static_cast<std::size_t>(k)] = difference.segment(begin_of(k), begin_of(k + 1) - begin_of(k)).squaredNorm();
  std::vector<Index> order(static_cast<std::size_t>(pieces));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, [&](Index a, Index b) {
    return squares[static_cast<std::size_t>(a)] > squares[static_cast<std::size_t>(b)];
  });
  std::vector<bool> taken(static_cast<std::size_t>(pieces), false);
  double sum = 0.0;
  for (auto piece = order.begin(); piece != order.end() && sum < 0.5 * all; ++piece) {
    taken[static_cast<std::size_t>(*piece)] = true;
    sum += squares[static_cast<std::size_t>(*piece)];
  }
  std::vector<MisfitInterval> out;
  for (Index k = 0; k < pieces; ++k) {
    if (!taken[static_cast<std::size_t>(k)]) continue;
    const auto begin = static_cast<std::size_t>(begin_of(k)), end = static_cast<std::size_t>(begin_of(k + 1) - 1);
    const double share = squares[static_cast<std::size_t>(k)] / all;
    if (k > 0 && taken[static_cast<std::size_t>(k - 1)])
      out.back().end_s = time_s[end], out.back().misfit_share += share;
    else
      out.push_back({time_s[begin], time_s[end], share});
  }
  std::ranges::sort(out, [](const auto& a, const auto& b) { return a.misfit_share > b.misfit_share; });
  if (out.size() > kMost) out.resize(kMost);
  return out;
}

}  // namespace sealwatch::trace
