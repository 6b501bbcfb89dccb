// The forecast of one who knows everything that can be known: the recursion (degradation.hpp), its constants, this
// seal's own limits and its present state. Only the future irregularity is open. No forecaster can do better in the
// mean, so it is the yardstick (docs/forecast.md).
//
// Given the present, theta(n + h) is linear in independent uniform variables, hence symmetric about its mean: the
// median of the crossing month is exact, and the normal distribution with the same mean and variance stands for the
// rest. gamma + Upsilon > 0 from the second year on, so that theta falls every month and P(T <= h) = P(theta(n + h) <=
// theta_max).
#pragma once

#include "sealwatch/forecast/degradation.hpp"
#include "sealwatch/forecast/predictive_distribution.hpp"

namespace sealwatch::forecast {

struct TrueState {
  double month = 0.0;             ///< n
  double condition = 1.0;         ///< theta(n)
  double gamma = 0.0;             ///< gamma(n)
  double steepening_limit = 0.0;  ///< Gamma_max of this seal
};

/// Remaining life in months from `state.month`. An Error when the threshold is passed or the state makes no sense.
[[nodiscard]] Result<PredictiveDistribution> oracle_distribution(const TrueState& state, double threshold,
                                                                 const DegradationSetting& setting = {});

}  // namespace sealwatch::forecast
