// Daemon of layer 5.
#include "sealwatch/estimation/pem_estimator.hpp"
#include "sealwatch/forecast/configured.hpp"
#include "services/common/core/build_version.hpp"
#include "services/common/runtime/daemon.hpp"
#include "services/common/transport/dds_bus.hpp"
#include "services/prognostic_assessment/prognostic_assessment.hpp"

int main(int argc, char** argv) {
  using namespace sealwatch;
  const std::unique_ptr<Estimator> estimator = make_pem_estimator();
  const auto make_layer = [&](const Configuration& configuration, const Clock&) -> std::unique_ptr<Layer> {
    return prognostic_assessment::PrognosticAssessment::make(
               configuration, *estimator, {.forecasters = forecast::configured_forecasters(configuration)})
        .value();
  };
  return run_daemon(argc, argv,
                    {.service = "prognostic_assessment",
                     .version_line = version_line(),
                     .make_layer = make_layer,
                     .make_bus = make_dds_bus,
                     .refused_by_bus = refused_by_dds});
}
