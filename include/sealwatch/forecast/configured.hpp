// The forecasters that a configuration asks for.
#pragma once

#include <vector>

#include "sealwatch/config/configuration.hpp"
#include "sealwatch/forecast/forecaster.hpp"

namespace sealwatch::forecast {

[[nodiscard]] ForecasterSettings configured_forecaster(const ForecasterConfig& config);
/// The primary one first; the default ones where the configuration names none.
[[nodiscard]] std::vector<ForecasterSettings> configured_forecasters(const Configuration& configuration);

}  // namespace sealwatch::forecast
