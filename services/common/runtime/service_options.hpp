// What the configuration says about a service's own work: forecasters, advice.
#pragma once

#include <string>

#include "sealwatch/config/configuration.hpp"
#include "services/common/runtime/yaml_map.hpp"

namespace sealwatch {

/// Reads the keys of `service` that are about its work; `map` is the mapping under its name.
void read_service_options(const std::string& service, YamlMap& map, Configuration& configuration);

}  // namespace sealwatch
