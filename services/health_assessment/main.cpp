// Daemon of layer 4.
#include "services/common/runtime/daemon.hpp"
#include "services/common/transport/dds_bus.hpp"
#include "services/health_assessment/health_assessment.hpp"

int main(int argc, char** argv) {
  using namespace sealwatch;
  const auto make_layer = [](const Configuration& configuration, const Clock&) {
    return std::make_unique<HealthAssessment>(configuration.assets);
  };
  return run_daemon(argc, argv, {.service = "health_assessment", .make_layer = make_layer, .make_bus = make_dds_bus});
}
