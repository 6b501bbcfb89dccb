// The first lines of `sealwatch status`: whether the services are well, and which actuators ask for something.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sealwatch/core/time.hpp"
#include "services/cli/service_alarms.hpp"
#include "services/cli/services_heard.hpp"
#include "services/cli/summary.hpp"

namespace sealwatch::cli {

/// "6 of 6 services well, 1 alarm, 2 ended alarms to acknowledge", then a line for each actuator whose advice asks for
/// something: "XT03-MV2: HIGH, book vessel, latest by 2018-05-31".
[[nodiscard]] std::string status_overview(const std::vector<ServicesHeard::Service>& services,
                                          const std::vector<HeardAlarm>& alarms,
                                          const std::map<std::string, AssetView>& assets, UtcTime now);

}  // namespace sealwatch::cli
