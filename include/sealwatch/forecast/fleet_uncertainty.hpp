// How well a fleet's own histories tell its ageing constants, and what that does to the forecast of one more seal.
//
//   of the means:         the random effects' own (fleet_population.hpp); leaving lives out would see their scatter alone
//   of the irregularity:  by leaving out one life in turn, sqrt((n-1)/n sum_i (m_(-i) - mean m)^2)            (jackknife)
//                         with fewer than three lives, irregularity / sqrt(n + lives that the reference counts as)
//
// A seal that is not yet known is one of the fleet about a mean that is not known better than that: in a forecast the
// spread is sqrt(spread^2 + error^2), and so is the irregularity. An upper limit stands for itself.
#pragma once

#include <span>

#include "sealwatch/config/configuration.hpp"
#include "sealwatch/forecast/fleet_population.hpp"

namespace sealwatch::forecast {

struct FleetErrors {
  double initial_rate = 0.0;      ///< of the mean [1]
  double steepening = 0.0;        ///< of the mean [1 per month]
  double irregularity_std = 0.0;  ///< [1]; 0 of a limit
};

/// The standard errors of fit_population(fleet, reference, reference_lives), which must succeed.
[[nodiscard]] FleetErrors fleet_errors(std::span<const FleetLife> fleet, const FleetFit& fit,
                                       const FleetPopulation& reference = {}, double reference_lives = 4.0);

/// What a configuration keeps of a fit: spreads with the means' errors in them.
[[nodiscard]] FleetConstants constants_for_forecasts(const FleetPopulation& population, const FleetErrors& errors);

/// The population of such constants; the rest is the reference's.
[[nodiscard]] FleetPopulation population_of(const FleetConstants& constants, const FleetPopulation& reference = {});

}  // namespace sealwatch::forecast
