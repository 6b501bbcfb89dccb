// Daemon of layer 6.
#include "services/advisory_generation/advice_alarm.hpp"
#include "services/advisory_generation/advisory_generation.hpp"
#include "services/common/core/build_version.hpp"
#include "services/common/runtime/daemon.hpp"
#include "services/common/transport/dds_bus.hpp"

int main(int argc, char** argv) {
  using namespace sealwatch;
  const auto make_layer = [](const Configuration& configuration, const Clock&) -> std::unique_ptr<Layer> {
    return advisory_generation::AdvisoryGeneration::make(configuration, configuration.advice).value();
  };
  return run_daemon(argc, argv,
                    {.service = "advisory_generation",
                     .version_line = version_line(),
                     .make_layer = make_layer,
                     .make_bus = make_dds_bus,
                     .refused_by_bus = refused_by_dds,
                     .keeps_alarms = true,
                     .advice_of_output = advisory_generation::advice_alarm});
}
