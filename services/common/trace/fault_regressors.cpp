#include "services/common/trace/fault_regressors.hpp"

#include <algorithm>

namespace sealwatch::trace {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kMostPieces = 8;

/// tanh(v/v_k) and its square for several v_k: what rubs changes its sign with the speed, at whatever speed.
std::vector<VectorXd> saturations_of(const VectorXd& velocity) {
  std::vector<VectorXd> out;
  const double fastest = velocity.cwiseAbs().maxCoeff();
  for (const double share : {0.003, 0.01, 0.03, 0.1, 0.3}) {
    if (!(fastest > 0.0)) break;
    out.emplace_back((velocity.array() / (share * fastest)).tanh());
    out.emplace_back(out.back().array().square());
  }
  return out;
}

/// 1 in one piece of the samples each.
std::vector<VectorXd> pieces_of(Index samples, Index pieces, const SampleRange& range) {
  std::vector<VectorXd> out;
  for (Index k = 0; k < pieces; ++k) {
    const Index begin = k * samples / pieces, end = (k + 1) * samples / pieces;
    const Index from = std::clamp<Index>(begin - range.first, 0, range.count);
    const Index to = std::clamp<Index>(end - range.first, 0, range.count);
    out.push_back(VectorXd::Zero(range.count));
    out.back().segment(from, to - from).setOnes();
  }
  return out;
}

}  // namespace

void FaultRegressors::add_drive(const std::string& name, const VectorXd& values) {
  drives_.push_back({name, values, shape_of_(values).slope});
}

void FaultRegressors::set_motion(const VectorXd& velocity) {
  motion_ = regimes_of(velocity);
  saturations_ = saturations_of(velocity);
}

std::vector<Regime> FaultRegressors::regimes_of_course(const VectorXd& course) const {
  return motion_.empty() ? regimes_of(shape_of_(course).slope) : motion_;
}

std::vector<RegressorGroup> FaultRegressors::groups_of(const std::string& channel, const VectorXd& course,
                                                       const SampleRange& range) const {
  constexpr Index kSamplesAPiece = 12;
  const Index n = course.size();
  const auto [s, v, a] = shape_of_(course);
  const double begin_s = time_s_.front(), length_s = time_s_.back() - begin_s;
  VectorXd t(n);
  for (Index k = 0; k < n; ++k) t(k) = 2.0 * (time_s_[static_cast<std::size_t>(k)] - begin_s) / length_s - 1.0;
  const auto within = [&range](const VectorXd& column) -> VectorXd { return column.segment(range.first, range.count); };
  RegressorGroup shifts{"an offset, gain, delay or clock rate", {within(s), within(v), within(t.cwiseProduct(v))}};
  RegressorGroup regimes{"a mean that differs with motion or level", {}};
  for (const Regime& regime : motion_.empty() ? regimes_of(v) : motion_)
    regimes.columns.push_back(within(regime.indicator));
  for (const Regime& level : levels_of(s)) regimes.columns.push_back(within(level.indicator));
  for (const VectorXd& saturated : motion_.empty() ? saturations_of(v) : saturations_)
    regimes.columns.push_back(within(saturated));
  RegressorGroup shapes{"the curvature of the channel or the course of another one",
                        {within(a), within(s.cwiseProduct(s)), within(v.cwiseProduct(v.cwiseAbs()))}};
  for (const Drive& drive : drives_)
    if (drive.name != channel)
      shapes.columns.push_back(within(drive.values)), shapes.columns.push_back(within(drive.slope));
  const Index pieces = std::clamp<Index>(range.count / kSamplesAPiece, 1, kMostPieces);
  return {std::move(shifts),
          std::move(regimes),
          std::move(shapes),
          {"a mean that changes over time", pieces_of(n, pieces, range)}};
}

std::vector<RegressorGroup> FaultRegressors::partitions_of(const VectorXd& course, const SampleRange& range) const {
  RegressorGroup motion{"a spread that differs between motion and rest", {}};
  for (const Regime& regime : regimes_of_course(course))
    motion.columns.emplace_back(regime.indicator.segment(range.first, range.count));
  return {std::move(motion), {"a spread that changes over time", pieces_of(course.size(), kMostPieces, range)}};
}

}  // namespace sealwatch::trace
