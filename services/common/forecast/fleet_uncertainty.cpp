#include "sealwatch/forecast/fleet_uncertainty.hpp"

#include <cmath>
#include <vector>

namespace sealwatch::forecast {
namespace {

constexpr int kFewestForJackknife = 3;

double jackknife(const std::vector<double>& left_out) {
  const auto n = static_cast<double>(left_out.size());
  double mean = 0.0, squares = 0.0;
  for (const double value : left_out) mean += value / n;
  for (const double value : left_out) squares += (value - mean) * (value - mean);
  return std::sqrt((n - 1.0) / n * squares);
}

}  // namespace

FleetErrors fleet_errors(std::span<const FleetLife> fleet, const FleetFit& fit, const FleetPopulation& reference,
                         double reference_lives) {
  std::vector<double> irregularities;
  for (std::size_t out = 0; out < fleet.size() && fit.lives >= kFewestForJackknife; ++out) {
    std::vector<FleetLife> others(fleet.begin(), fleet.end());
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(out));
    const Result<FleetFit> without = fit_population(others, reference, reference_lives);
    if (!without || without->lives == fit.lives) continue;  // that life had taken no part
    irregularities.push_back(without->likeliest_irregularity);
  }
  FleetErrors errors{.initial_rate = fit.initial_rate_error,
                     .steepening = fit.steepening_error,
                     .irregularity_std = fit.population.irregularity_std / std::sqrt(fit.lives + reference_lives)};
  if (irregularities.size() >= static_cast<std::size_t>(kFewestForJackknife))
    if (const double scatter = jackknife(irregularities); scatter > 0.0) errors.irregularity_std = scatter;
  if (fit.irregularity_is_limit) errors.irregularity_std = 0.0;
  return errors;
}

FleetConstants constants_for_forecasts(const FleetPopulation& population, const FleetErrors& errors) {
  return {.initial_rate = population.initial_rate,
          .initial_rate_std = std::hypot(population.initial_rate_std, errors.initial_rate),
          .steepening = population.steepening,
          .steepening_std = std::hypot(population.steepening_std, errors.steepening),
          .rate_steepening_correlation = population.rate_steepening_correlation,
          .irregularity_std = std::hypot(population.irregularity_std, errors.irregularity_std)};
}

FleetPopulation population_of(const FleetConstants& constants, const FleetPopulation& reference) {
  FleetPopulation population = reference;
  population.initial_rate = constants.initial_rate;
  population.initial_rate_std = constants.initial_rate_std;
  population.steepening = constants.steepening;
  population.steepening_std = constants.steepening_std;
  population.rate_steepening_correlation = constants.rate_steepening_correlation;
  population.irregularity_std = constants.irregularity_std;
  return population;
}

}  // namespace sealwatch::forecast
