#include "sealwatch/forecast/configured.hpp"

#include "sealwatch/forecast/fleet_uncertainty.hpp"

namespace sealwatch::forecast {
namespace {

void take_population(std::vector<ForecasterSettings>& settings, const FleetPopulation& population) {
  for (ForecasterSettings& one : settings) {
    one.population = population;
    take_population(one.members, population);
  }
}

}  // namespace

ForecasterSettings configured_forecaster(const ForecasterConfig& config) {
  ForecasterSettings settings{.method = config.method, .window_months = config.window_months};
  for (const ForecasterConfig& member : config.members) settings.members.push_back(configured_forecaster(member));
  return settings;
}

std::vector<ForecasterSettings> configured_forecasters(const Configuration& configuration) {
  std::vector<ForecasterSettings> settings;
  for (const ForecasterConfig& config : configuration.forecasters) settings.push_back(configured_forecaster(config));
  if (settings.empty()) settings = default_forecasters();
  if (configuration.fleet) take_population(settings, population_of(*configuration.fleet));
  return settings;
}

}  // namespace sealwatch::forecast
