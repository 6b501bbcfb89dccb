// Daemon of layer 3.
#include "services/common/model/model_simulator.hpp"
#include "services/common/runtime/daemon.hpp"
#include "services/common/transport/dds_bus.hpp"
#include "services/state_detection/state_detection.hpp"

int main(int argc, char** argv) {
  using namespace sealwatch;
  const auto make_layer = [](const Configuration& configuration, const Clock&) {
    return std::make_unique<StateDetection>(configuration.assets, std::make_shared<ModelSimulator>(),
                                            StateDetectionOptions{.commissioned = configuration.commissioned});
  };
  return run_daemon(argc, argv, {.service = "state_detection", .make_layer = make_layer, .make_bus = make_dds_bus});
}
