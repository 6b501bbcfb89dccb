#include "services/cli/layers.hpp"

#include "sealwatch/estimation/pem_estimator.hpp"
#include "sealwatch/forecast/configured.hpp"
#include "services/advisory_generation/advisory_generation.hpp"
#include "services/common/mismatch/mismatch_explainer.hpp"
#include "services/common/model/model_simulator.hpp"
#include "services/common/runtime/asset_file.hpp"
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
  set.layers_.push_back(std::make_unique<DataAcquisition>(configuration.assets));
  set.layers_.push_back(std::make_unique<DataManipulation>(configuration.assets));
  set.layers_.push_back(std::make_unique<StateDetection>(configuration.assets, set.simulator_));
  set.layers_.push_back(std::make_unique<HealthAssessment>(configuration.assets, HealthAssessmentOptions{},
                                                           make_mismatch_explainer(asset_to_yaml)));
  auto prognostic = prognostic_assessment::PrognosticAssessment::make(
      configuration, *set.estimator_, {.forecasters = forecast::configured_forecasters(configuration)});
  if (!prognostic) return fail(prognostic.error());
  set.layers_.push_back(std::move(*prognostic));
  auto advisory = advisory_generation::AdvisoryGeneration::make(configuration, configuration.advice);
  if (!advisory) return fail(advisory.error());
  set.layers_.push_back(std::move(*advisory));
  return set;
}

std::map<std::string, std::vector<std::string>> LayerSet::inputs_by_layer() const {
  std::map<std::string, std::vector<std::string>> inputs;
  for (const auto& layer : layers_)
    for (const Topic topic : layer->inputs()) inputs[std::string(layer->name())].emplace_back(name_of(topic));
  return inputs;
}

}  // namespace sealwatch::cli
