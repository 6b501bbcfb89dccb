// Scores of probabilistic forecasts; intervals of shares and means from simulated lives. See docs/reference/metrics.md.
//
// Forecasts of one life share its noise and its irregularity: they are one cluster, not so many independent trials.
// Means over forecasts therefore have their standard error from the lives (ratio estimator):
//
//   m = sum_i S_i / sum_i n_i,   SE^2 = L/(L-1) sum_i (S_i - m n_i)^2 / (sum_i n_i)^2
//
//   S_i, n_i  sum and number of the values of life i;  L number of lives
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sealwatch/core/result.hpp"

namespace sealwatch::forecast {

/// Interval score of a central interval of `level` (Gneiting, Raftery 2007, eq. 43): width plus 2/(1 - level) times the
/// distance by which `observed` lies outside. Smaller is better.
[[nodiscard]] double interval_score(double low, double high, double level, double observed);

/// CRPS of a normal distribution (Gneiting, Raftery 2007, eq. 21).
[[nodiscard]] double normal_crps(double mean, double standard_deviation, double observed);

/// Counts of values in [0, 1] in `bins` equal bins; the last holds 1 too.
[[nodiscard]] std::vector<int> histogram(std::span<const double> probabilities, int bins);

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// Exact interval of a share from `successes` in `trials` independent trials (C. J. Clopper, E. S. Pearson 1934).
[[nodiscard]] Result<Interval> clopper_pearson(int successes, int trials, double level = 0.95);

/// Sum and number of the values of one life.
struct Cluster {
  double sum = 0.0;
  int count = 0;
};

struct ClusteredMean {
  double mean = 0.0;
  double standard_error = 0.0;  ///< clustered by life
  int values = 0;
  int lives = 0;
};
/// An Error with fewer than two lives that have a value.
[[nodiscard]] Result<ClusteredMean> clustered_mean(std::span<const Cluster> lives);

}  // namespace sealwatch::forecast
