// What a fleet of like actuators says about a seal before it has told much about itself.
//
// The degradation law (degradation.hpp) with the mean of its irregularity in the rate, g = gamma + mean(Upsilon):
//
//   theta(n) = theta(n-1) - (g(n) + u(n)) ln((n + n_0)/(n - 1 + n_0)),   g(n) = g(n-1) + mu + w(n)
//
//   u   irregularity of the month, mean 0, standard deviation irregularity_std [1]
//   w   scatter of the steepening, mean 0, standard deviation steepening_scatter [1]
//   theta(0), g(0), mu  one seal's own; over the fleet normal with the means and standard deviations below
//
// A fit pools complete or running lives: each gives a generalised least-squares estimate of its (g(0), mu) with its
// covariance, expectation-maximisation (A. P. Dempster, N. M. Laird, D. B. Rubin 1977; random effects: N. M. Laird, J.
// H. Ware 1982) separates the spread of the fleet from those, and the reference counts as k = `reference_lives` lives.
// The means' errors hold the scatter between lives and each life's own, by the same model (generalised least squares):
//
//   cov(mean) = A^-1 W A^-1,   W = sum_i (D + V_i)^-1,   A = W + k D^-1: the reference pulls, and does not scatter
//   D spread of the fleet; V_i covariance of life i's own (g(0), mu)
//
// Lives that are as regular as the least irregularity that is tried tell no irregularity, but an upper limit: where
// -2 ln likelihood is 2.71 above its least.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "sealwatch/core/result.hpp"
#include "sealwatch/core/time.hpp"
#include "sealwatch/forecast/condition_history.hpp"
#include "sealwatch/forecast/degradation.hpp"

namespace sealwatch::forecast {

struct FleetPopulation {
  double n_0 = 1.0;                        ///< [months]
  double initial_condition = 1.0;          ///< mean of theta(0) [1]
  double initial_condition_std = 0.01;     ///< [1]
  double initial_rate = 0.045;             ///< mean of g(0) [1]
  double initial_rate_std = 0.0057735;     ///< [1]
  double steepening = 0.00115;             ///< mean of mu [1 per month]
  double steepening_std = 0.00020207;      ///< [1 per month]
  double rate_steepening_correlation = 0;  ///< of g(0) and mu over the fleet [1]
  double steepening_scatter = 0.00067406;  ///< standard deviation of w [1]
  double irregularity_std = 0.037528;      ///< standard deviation of u [1]

  [[nodiscard]] Status validate() const;
};

/// The population that the degradation constants describe. The defaults above are those of DegradationSetting.
[[nodiscard]] FleetPopulation reference_population(const DegradationSetting& setting = {});

/// Months that the mean seal of the population (u = w = 0) takes from `condition` to `threshold` [1]: 0 where it is
/// there already, infinity where it takes more than 1200.
[[nodiscard]] double mean_remaining_months(double condition, double threshold, const FleetPopulation& population = {});

/// One seal of the fleet.
struct FleetLife {
  std::vector<ConditionSample> history;  ///< in the order of time
  UtcTime installed;
};

struct FleetFit {
  FleetPopulation population;
  double initial_rate_error = 0.0;      ///< standard error of the mean [1]
  double steepening_error = 0.0;        ///< standard error of the mean [1 per month]
  double likeliest_irregularity = 0.0;  ///< at least a quarter of the reference's [1]
  bool irregularity_is_limit = false;   ///< the population's is its upper limit at 95 %: the lives show none
  int lives = 0;                        ///< that took part
  int passed_over = 0;                  ///< fewer than `kFewestTestsOfLife` tests
};
inline constexpr int kFewestTestsOfLife = 12;

/// An Error for an empty fleet, or one in which no life has enough tests.
[[nodiscard]] Result<FleetFit> fit_population(std::span<const FleetLife> fleet, const FleetPopulation& reference = {},
                                              double reference_lives = 4.0);

}  // namespace sealwatch::forecast
