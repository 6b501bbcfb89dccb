// Daemon of layer 3.
#include "services/common/core/build_version.hpp"
#include "services/common/model/model_simulator.hpp"
#include "services/common/runtime/daemon.hpp"
#include "services/common/transport/dds_bus.hpp"
#include "services/state_detection/sensor_alarms.hpp"
#include "services/state_detection/state_detection.hpp"

int main(int argc, char** argv) {
  using namespace sealwatch;
  const auto make_layer = [](const Configuration& configuration, const Clock&) {
    return std::make_unique<StateDetection>(configuration.assets, std::make_shared<ModelSimulator>(),
                                            StateDetectionOptions{.commissioned = configuration.commissioned});
  };
  const auto make_alarms = [] {
    const auto lost = std::make_shared<LostSensors>();
    return [lost](const Message& output) { return lost->look(output); };
  };
  return run_daemon(argc, argv,
                    {.service = "state_detection",
                     .version_line = version_line(),
                     .make_layer = make_layer,
                     .make_bus = make_dds_bus,
                     .refused_by_bus = refused_by_dds,
                     .make_alarms_of_output = make_alarms});
}
