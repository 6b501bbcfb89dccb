// Daemon of layer 4.
#include "services/common/core/build_version.hpp"
#include "services/common/mismatch/mismatch_explainer.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "services/common/runtime/daemon.hpp"
#include "services/common/transport/dds_bus.hpp"
#include "services/health_assessment/health_assessment.hpp"

int main(int argc, char** argv) {
  using namespace sealwatch;
  const std::shared_ptr<const Explainer> explainer = make_mismatch_explainer(asset_to_yaml);
  const auto make_layer = [&](const Configuration& configuration, const Clock&) {
    return std::make_unique<HealthAssessment>(configuration.assets, HealthAssessmentOptions{}, explainer);
  };
  return run_daemon(argc, argv,
                    {.service = "health_assessment",
                     .version_line = version_line(),
                     .make_layer = make_layer,
                     .make_bus = make_dds_bus,
                     .refused_by_bus = refused_by_dds});
}
