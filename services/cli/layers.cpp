#include "services/cli/layers.hpp"

#include "sealwatch/estimation/pem_estimator.hpp"
#include "sealwatch/forecast/configured.hpp"
#include "services/advisory_generation/advisory_generation.hpp"
#include "services/common/mismatch/mismatch_explainer.hpp"
#include "services/common/model/model_simulator.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "services/common/runtime/configuration_loader.hpp"
#include "services/data_acquisition/data_acquisition.hpp"
#include "services/data_manipulation/data_manipulation.hpp"
#include "services/health_assessment/health_assessment.hpp"
#include "services/prognostic_assessment/prognostic_assessment.hpp"
#include "services/state_detection/state_detection.hpp"

namespace sealwatch::cli {

Result<LayerSet> LayerSet::make(const Configuration& configuration) {
  LayerSet set;
  set.simulator_ = std::make_shared<ModelSimulator>();
  set.estimator_ = make_pem_estimator();
  const auto explainer = make_mismatch_explainer(asset_to_yaml);
  const prognostic_assessment::Options prognosis{.forecasters = forecast::configured_forecasters(configuration)};
  if (const auto valid = prognostic_assessment::PrognosticAssessment::make(configuration, *set.estimator_, prognosis);
      !valid)
    return fail(valid.error());
  if (const auto valid = advisory_generation::AdvisoryGeneration::make(configuration, configuration.advice); !valid)
    return fail(valid.error());
  const auto add = [&set, of_asset = configurations_of_assets(configuration)](auto make) {
    set.makers_.emplace_back(
        [make, of_asset](const std::string& asset_id) -> std::unique_ptr<Layer> { return make(of_asset(asset_id)); });
  };
  add([](const Configuration& c) { return std::make_unique<DataAcquisition>(c.assets); });
  add([](const Configuration& c) { return std::make_unique<DataManipulation>(c.assets); });
  add([simulator = set.simulator_](const Configuration& c) {
    return std::make_unique<StateDetection>(c.assets, simulator, StateDetectionOptions{.commissioned = c.commissioned});
  });
  add([explainer](const Configuration& c) {
    return std::make_unique<HealthAssessment>(c.assets, HealthAssessmentOptions{}, explainer);
  });
  add([estimator = set.estimator_, prognosis](const Configuration& c) {
    return prognostic_assessment::PrognosticAssessment::make(c, *estimator, prognosis).value();
  });
  add([](const Configuration& c) { return advisory_generation::AdvisoryGeneration::make(c, c.advice).value(); });
  return set;
}

std::map<std::string, std::vector<std::string>> LayerSet::inputs_by_layer() const {
  std::map<std::string, std::vector<std::string>> inputs;
  for (const LayerMaker& make : makers_) {
    const std::unique_ptr<Layer> layer = make({});
    for (const Topic topic : layer->inputs()) inputs[std::string(layer->name())].emplace_back(name_of(topic));
  }
  return inputs;
}

}  // namespace sealwatch::cli
