// What an actuator is doing, sample by sample, from its motion: at rest, moving either way, reversing; and at which level
// a channel is.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "sealwatch/trace/trace_comparison.hpp"

namespace sealwatch::trace {

struct Regime {
  std::string name;
  Eigen::VectorXd indicator;  ///< 1 inside, 0 outside
};

/// `velocity` of whatever moves; it runs above 5 % of its 95th percentile. Reversing: within 1 % of the samples of a start,
/// stop or change of direction.
[[nodiscard]] std::vector<Regime> regimes_of(const Eigen::VectorXd& velocity);

/// Lower, middle and upper third of what the course goes through.
[[nodiscard]] std::vector<Regime> levels_of(const Eigen::VectorXd& course);

[[nodiscard]] std::vector<RegimeMisfit> misfit_by_regime(const Eigen::VectorXd& difference,
                                                         const std::vector<Regime>& regimes);

/// The fewest pieces of a fiftieth of the time that hold half of the misfit, neighbours joined; at most three, the largest
/// first.
[[nodiscard]] std::vector<MisfitInterval> misfit_by_time(const std::vector<double>& time_s,
                                                         const Eigen::VectorXd& difference);

}  // namespace sealwatch::trace
