#include "services/common/mismatch/orders.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>

#include "services/common/core/in_parallel.hpp"
#include "services/common/mismatch/term_path.hpp"

namespace sealwatch::mismatch {
namespace {

constexpr double kBlock_s = 1.0;
constexpr double kLongestStep_s = 0.02;  // of the angle's integration
constexpr std::size_t kPeriods = 1;      // the law's parameter: periods in a turn
constexpr double kIndependent = 1e-3;    // of a column's square, from which it is no mean and no slope
constexpr Eigen::Index kFewestRows = 8;  // of a block

// The shaft's angle at the samples, its speed linear between the steps of the simulation.
Eigen::VectorXd angle_at(const TermPath& path, const std::vector<double>& time_s) {
  Eigen::VectorXd angle(std::ssize(time_s));
  double theta = 0.0;
  std::size_t step = 0;
  for (std::size_t k = 0; k < time_s.size(); ++k) {
    const auto advance_to = [&](double t) {
      const double h = path.time_s[step + 1] - path.time_s[step],
                   slope = path.signals[step + 1][0] - path.signals[step][0];
      const double dt = t - path.time_s[step];
      return path.signals[step][0] * dt + 0.5 * slope * dt * dt / h;
    };
    for (; step + 2 < path.time_s.size() && path.time_s[step + 1] <= time_s[k]; ++step)
      theta += advance_to(path.time_s[step + 1]);
    angle(static_cast<Eigen::Index>(k)) = theta + advance_to(time_s[k]);
  }
  return angle;
}

// Of one block: what cosine and sine take off all channels (columns of `residual`) beyond their mean and slope.
double line_energy(const Eigen::Ref<const Eigen::VectorXd>& phase, const Eigen::Ref<const RowMatrix>& residual) {
  const Eigen::Index rows = phase.size();
  Eigen::Matrix<double, Eigen::Dynamic, 4> columns(rows, 4);
  columns.col(0).setOnes();
  columns.col(1) = Eigen::VectorXd::LinSpaced(rows, -1.0, 1.0);
  columns.col(2) = phase.array().cos();
  columns.col(3) = phase.array().sin();
  double energy = 0.0;
  for (Eigen::Index k = 0; k < 4; ++k) {
    const double before = columns.col(k).squaredNorm();
    for (Eigen::Index j = 0; j < k; ++j) columns.col(k) -= columns.col(j).dot(columns.col(k)) * columns.col(j);
    const double left = columns.col(k).squaredNorm();
    if (left < kIndependent * before) {
      columns.col(k).setZero();
      continue;
    }
    columns.col(k) /= std::sqrt(left);
    if (k >= 2) energy += (columns.col(k).transpose() * residual).squaredNorm();
  }
  return energy;
}

// Of `count` orders from `least` on, in one recording.
std::vector<double> energies_in(const FittedModel& model, std::size_t recording, const Candidate& candidate, int least,
                                std::size_t count) {
  std::vector<double> energies(count, 0.0);
  const auto path =
      term_path(point_of(model, recording), candidate.element, candidate.law->kind, nullptr, {}, kLongestStep_s);
  if (!path || path->time_s.size() < 2) return energies;
  const PemRecording& part = model.problem.recordings[recording];
  const Linearisation& at = model.optimum.at_optimum[recording];
  const Eigen::VectorXd angle = angle_at(*path, part.time_s);
  const Eigen::Map<const RowMatrix> residual(at.residual.data(), at.simulated.rows(), at.simulated.cols());
  for (Eigen::Index begin = 0, end = 0; begin < angle.size(); begin = end) {
    const double until_s = part.time_s[static_cast<std::size_t>(begin)] + kBlock_s;
    while (end < angle.size() && part.time_s[static_cast<std::size_t>(end)] < until_s) ++end;
    const Eigen::Index rows = end - begin;
    if (rows < kFewestRows) continue;
    for (std::size_t k = 0; k < count; ++k)
      energies[k] +=
          line_energy((least + static_cast<int>(k)) * angle.segment(begin, rows), residual.middleRows(begin, rows));
  }
  return energies;
}

std::vector<double> energies_of(const Candidate& candidate, const FittedModel& model, int least, int most,
                                int threads) {
  std::vector<double> energies(static_cast<std::size_t>(most - least + 1), 0.0);
  const auto parts = in_parallel<std::vector<double>>(model.problem.recordings.size(), threads, [&](std::size_t k) {
    return energies_in(model, k, candidate, least, energies.size());
  });
  for (const std::vector<double>& part : parts) std::ranges::transform(energies, part, energies.begin(), std::plus<>());
  return energies;
}

}  // namespace

void set_out_from_strongest_orders(std::vector<Candidate>& candidates, const FittedModel& model, int threads) {
  for (Candidate& candidate : candidates) {
    if (!candidate.law->hidden || !candidate.law->hidden->shaft_angle) continue;
    const LawParameter& periods = candidate.law->parameters[kPeriods];
    const int least = static_cast<int>(periods.min), most = static_cast<int>(periods.max);
    const std::vector<double> energies = energies_of(candidate, model, least, most, threads);
    std::vector<int> orders;
    for (int order = least; order <= most; ++order)
      if (energies[static_cast<std::size_t>(order - least)] > 0.0) orders.push_back(order);
    std::ranges::stable_sort(orders, std::greater<>(),
                             [&](int order) { return energies[static_cast<std::size_t>(order - least)]; });
    const std::size_t asked = std::min(orders.size(), candidate.grid.size());
    for (std::size_t k = 0; k < asked; ++k) candidate.grid[k][kPeriods] = orders[k];
    candidate.passed_over = orders.size() - asked;
  }
}

}  // namespace sealwatch::mismatch
