// Daemon of layer 2.
#include "services/common/core/build_version.hpp"
#include "services/common/runtime/daemon.hpp"
#include "services/common/transport/dds_bus.hpp"
#include "services/data_manipulation/data_manipulation.hpp"
#include "services/data_manipulation/refused_tests.hpp"

int main(int argc, char** argv) {
  using namespace sealwatch;
  const auto make_alarms = [] {
    const auto refused = std::make_shared<RefusedTests>();
    return [refused](const Message& output) { return refused->look(output); };
  };
  return run_daemon(
      argc, argv,
      {.service = "data_manipulation",
       .version_line = version_line(),
       .make_layer = [](const Configuration& configuration,
                        const Clock&) { return std::make_unique<DataManipulation>(configuration.assets); },
       .make_bus = make_dds_bus,
       .refused_by_bus = refused_by_dds,
       .make_alarms_of_output = make_alarms});
}
