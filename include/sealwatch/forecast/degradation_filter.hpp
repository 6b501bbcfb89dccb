// State-space estimation of one seal: a Kalman filter that carries the degradation law.
//
//   x = (theta, g, mu)                        condition, rate against ln t, monthly steepening (fleet_population.hpp)
//   one step of d months, A = ln((t + d + n_0)/(t + n_0)):
//     mu' = mu,   g' = g + mu d + w,   theta' = theta - (g' + u) A
//     Var(w) = k^2 steepening_scatter^2 d,   Var(u A) = k^2 irregularity_std^2 A^2 / d
//     k           how many times as fast as by the law it ages: 1, until something makes it age faster (age_faster)
//   measured    y = theta + e,   Var(e) = s^2, the estimate's own standard error
//
// Given the constants everything is linear and normal, so the filter is exact (R. E. Kalman 1960) and the remaining
// life follows in closed form: from the second year on theta falls every month, hence
// P(T <= h) = P(theta(now + h) <= theta_max), a normal probability.
//
// Outliers: e comes from (1 - eps) N(0, s^2) + eps N(0, (k s)^2 + wide^2). Each update makes the two posteriors and
// joins them to one normal with their mean and covariance: a month that cannot be believed moves little, and widens.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sealwatch/forecast/fleet_population.hpp"
#include "sealwatch/forecast/predictive_distribution.hpp"

namespace sealwatch::forecast {

/// The constants that the filter takes for known.
struct DegradationLaw {
  double n_0 = 1.0;
  double steepening_scatter = 0.00067406;
  double irregularity_std = 0.037528;
};

/// Joint normal belief about (theta, g, mu) at an age.
struct SealBelief {
  double age_months = 0.0;             ///< t, since installation
  std::array<double, 3> mean{};        ///< theta, g, mu
  std::array<double, 6> covariance{};  ///< upper triangle by rows: tt, tg, tm, gg, gm, mm
  double log_evidence = 0.0;           ///< sum of the logarithms of the predictive densities so far
  double surprise_squares = 0.0;       ///< sum of squared standardised innovations, each cut at 9
  int tests = 0;
  double ageing_factor = 1.0;  ///< k
};

/// What is known of a new seal; `spread` widens every standard deviation of the population.
[[nodiscard]] SealBelief new_seal(const FleetPopulation& population, double spread = 1.0);

/// Carries the belief on to `age_months` in steps of at most about a month. Not back.
void grow_old(SealBelief& belief, const DegradationLaw& law, double age_months);

/// From now on it ages k `times` as fast, k known to `spread` of itself: every month's fall is k times what it would
/// have been, so that g, mu, w and u are. (The acceleration factor of accelerated life tests: W. B. Nelson 1990.)
void age_faster(SealBelief& belief, double times, double spread);

/// Takes a test in.
void observe(SealBelief& belief, double condition, double condition_std);

/// A hypothesis with its probability.
struct WeightedBelief {
  SealBelief belief;
  double weight = 1.0;
};

/// Distribution of the months until theta <= threshold; all beliefs stand at the same time ("now"), ages may differ.
/// Cut at `longest_months`. An Error without a belief, or where a belief or the threshold is no number.
[[nodiscard]] Result<PredictiveDistribution> crossing_distribution(std::span<const WeightedBelief> beliefs,
                                                                   const DegradationLaw& law, double threshold,
                                                                   double longest_months);

}  // namespace sealwatch::forecast
