#include "sealwatch/forecast/configured.hpp"

namespace sealwatch::forecast {

ForecasterSettings configured_forecaster(const ForecasterConfig& config) {
  ForecasterSettings settings{.method = config.method, .window_months = config.window_months};
  for (const ForecasterConfig& member : config.members) settings.members.push_back(configured_forecaster(member));
  return settings;
}

std::vector<ForecasterSettings> configured_forecasters(const Configuration& configuration) {
  if (configuration.forecasters.empty()) return default_forecasters();
  std::vector<ForecasterSettings> settings;
  for (const ForecasterConfig& config : configuration.forecasters) settings.push_back(configured_forecaster(config));
  return settings;
}

}  // namespace sealwatch::forecast
