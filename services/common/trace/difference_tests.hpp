// Whether a residual is noise of whatever colour, or owes something to the course that it is the residual of.
//
//   r = X_g beta + e   against   r = e,   e autoregressive in both (coloured_regression.hpp)
//
// for groups g of regressors that a simulation's faults leave behind: a shift or scaling of the course; direction,
// standstill, reversal and level; pieces of the time; curvature and what drives the simulation. Twice the gain in log
// likelihood is chi-squared for noise that knows nothing of the simulation, with as many degrees of freedom as the group
// has columns that say something new.
//
// Noise that smooth takes a step for one large innovation; but innovations that scatter more in one regime than in another
// know of the simulation, too. Their variances s_k^2 in the parts k of a partition against one s^2, without the samples
// that the simulation, known at times of its own, leaves open:
//   sum_k n_k (log s^2 - log s_k^2) / ((kappa - 1) / 2)     chi-squared, kappa the innovations' kurtosis within the parts
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "sealwatch/trace/coloured_regression.hpp"

namespace sealwatch::trace {

struct RegressorGroup {
  std::string name;  ///< in words: "an offset, gain, delay or clock rate"
  std::vector<Eigen::VectorXd> columns;
};

struct GroupTest {
  std::string name;
  double p_value = 1.0;
};

struct NoiseTest {
  std::vector<GroupTest> groups;
  double p_value = 1.0;            ///< of the most telling group, times the number of groups
  double effective_samples = 0.0;  ///< of the noise
  double noise_std = 0.0;          ///< of what no group explains
};

/// Of one sample, the channel's unit squared.
struct LeastVariances {
  double arithmetic = 0.0;       ///< rounding of numbers
  double steps = 0.0;            ///< of what the channel is recorded in: at rest they may show no noise at all
  Eigen::VectorXd between = {};  ///< of each sample, what the simulation's samples leave open; empty: nothing
};

/// The constant is in every group by itself. `partitions`: columns of 0 and 1, one 1 a row at most. `joints`: gaps in the
/// residual (coloured_regression.hpp).
[[nodiscard]] NoiseTest test_noise(const Eigen::VectorXd& residual, std::vector<RegressorGroup> groups,
                                   const std::vector<RegressorGroup>& partitions, const LeastVariances& least,
                                   const Joints& joints = {});

}  // namespace sealwatch::trace
