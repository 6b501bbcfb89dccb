// A daemon's main, around one layer:
//
//   int main(int argc, char** argv) {
//     return sealwatch::run_daemon(argc, argv, {.service = "state_detection",
//                                               .version_line = version_line(),
//                                               .make_layer = [](const Configuration& c, const Clock&) { ... },
//                                               .make_bus = sealwatch::make_dds_bus});
//   }
//
// Exit status: 0 stopped by SIGTERM or SIGINT, 2 bad usage or configuration, 3 internal failure (the service manager
// starts the daemon again and it goes on from its journal).
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/config/configuration.hpp"
#include "sealwatch/port/bus.hpp"
#include "sealwatch/port/layer.hpp"
#include "services/common/runtime/layer_runner.hpp"

namespace sealwatch {

/// Environment variable with the process id of the supervisor that a service ends with.
inline constexpr const char* kSupervisor = "SEALWATCH_SUPERVISOR";

struct DaemonParts {
  std::string service;       ///< "state_detection"
  std::string version_line;  ///< what --version says
  /// Makes the layer of one asset, from a configuration that has no other.
  std::function<std::unique_ptr<Layer>(const Configuration&, const Clock&)> make_layer;
  std::function<Result<std::unique_ptr<Bus>>(const Configuration&)> make_bus;
  /// Optional: inputs that come from no bus, see RunnerOptions::local_inputs.
  std::function<std::shared_ptr<LocalInputs>(const Configuration&)> make_local_inputs = {};
  /// Optional: see RunnerOptions.
  std::function<std::optional<std::string>()> refused_by_bus = {};
  std::function<AlarmsOfOutput()> make_alarms_of_output = {};
  bool keeps_alarms = false;             ///< this service has the alarm desk
  AdviceOfOutput advice_of_output = {};  ///< for the desk
};

[[nodiscard]] int run_daemon(int argc, const char* const* argv, const DaemonParts& parts);

}  // namespace sealwatch
