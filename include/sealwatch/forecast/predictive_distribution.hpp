// Predictive distribution of a remaining life: what a forecast says about every date, not about a few levels alone.
//
//   F(t) = P(T <= t),  t >= 0   piecewise linear between points (t_j, F_j)
//
//   T  remaining life [months]; F(0) > 0 is the probability of having failed already; what is left above the last
//      point, 1 - F(t_last), is the probability of an end beyond it and counts as if it were at t_last
//
// With such an F the continuous ranked probability score (J. E. Matheson, R. L. Winkler 1976; T. Gneiting, A. E.
// Raftery 2007, eq. 20) is a sum of exact integrals:
//
//   CRPS(F, y) = integral over t of (F(t) - [y <= t])^2        [months]; for a point forecast the absolute error
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sealwatch/core/result.hpp"

namespace sealwatch::forecast {

/// The levels whose quantiles are reported: ends of the 50, 80, 90 and 95 % intervals, and the median.
inline constexpr std::array<double, 9> kReportedLevels{0.025, 0.05, 0.10, 0.25, 0.50, 0.75, 0.90, 0.95, 0.975};

class PredictiveDistribution {
 public:
  struct Point {
    double months = 0.0;       ///< t_j, finite, >= 0
    double probability = 0.0;  ///< F_j
  };

  /// An Error unless there is a point, months and probabilities do not fall, and probabilities are within [0, 1].
  [[nodiscard]] static Result<PredictiveDistribution> make(std::vector<Point> points);

  [[nodiscard]] double cdf(double months) const;
  /// The earliest t with F(t) >= probability; t_last where F never gets there.
  [[nodiscard]] double quantile(double probability) const;
  [[nodiscard]] double mean() const;
  /// E[max(t - T, 0)]: months between the end of life and `months`, the integral of F up to there.
  [[nodiscard]] double expected_months_failed_before(double months) const;
  [[nodiscard]] double crps(double observed_months) const;
  /// Quantiles at kReportedLevels.
  [[nodiscard]] std::array<double, kReportedLevels.size()> reported_quantiles() const;
  [[nodiscard]] std::span<const Point> points() const { return points_; }

 private:
  explicit PredictiveDistribution(std::vector<Point> points) : points_(std::move(points)) {}
  std::vector<Point> points_;
};

/// Weighted mean of distributions (linear opinion pool). Weights are positive and are normalised here.
[[nodiscard]] Result<PredictiveDistribution> pool(std::span<const PredictiveDistribution> members,
                                                  std::span<const double> weights);

}  // namespace sealwatch::forecast
