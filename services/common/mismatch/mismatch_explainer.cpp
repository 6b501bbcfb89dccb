#include "services/common/mismatch/mismatch_explainer.hpp"

#include <cmath>
#include <utility>

namespace sealwatch {
namespace {

ModelParameter parameter_of(const std::string& name, const ParameterSetting& setting) {
  return {.name = name, .value = setting.value, .min = setting.min, .max = setting.max, .estimate = setting.estimate};
}

std::vector<ModelParameter> parameters_of(const std::map<std::string, ParameterSetting>& settings) {
  std::vector<ModelParameter> parameters;
  for (const auto& [name, setting] : settings) parameters.push_back(parameter_of(name, setting));
  return parameters;
}

ExplainedModel model_of(const AssetConfig& asset) {
  ExplainedModel model{.model = asset.model, .parameters = parameters_of(asset.parameters), .physics = {}};
  for (const PhysicsTerm& term : asset.physics)
    model.physics.push_back({.id = term.id, .element = term.element, .parameters = parameters_of(term.parameters)});
  return model;
}

DiscrepancyPhysics physics_of(const mismatch::FoundEffect& effect) {
  DiscrepancyPhysics physics;
  physics.id = effect.what.id;
  physics.element = effect.what.element;
  physics.law = effect.what.law;
  physics.meaning = effect.what.meaning;
  physics.probability = effect.probability;
  physics.regime = effect.regime;
  for (const mismatch::FoundParameter& found : effect.parameters) {
    const bool known = std::isfinite(found.std_error);
    physics.parameters.push_back({found.name, found.unit, found.value, known, known ? found.std_error : 0.0});
  }
  for (const mismatch::LawAt& other : effect.indistinguishable)
    if (!effect.is_another_form(other))
      physics.indistinguishable_from.push_back(std::string(other.id).append(" at ").append(other.element));
  return physics;
}

class MismatchExplainer final : public Explainer {
 public:
  MismatchExplainer(AssetWriter write_asset, const mismatch::ExplainOptions& options)
      : write_asset_(std::move(write_asset)), options_(options) {}

  [[nodiscard]] ModelDiscrepancy explain(const AssetConfig& asset, std::span<const Recording> fit,
                                         std::span<const Recording> holdout,
                                         const std::stop_token& cancel) const override {
    mismatch::ExplainOptions options = options_;
    options.cancel = cancel;
    const auto explanation = mismatch::explain(asset, fit, holdout, options);
    if (!explanation) {
      ModelDiscrepancy impossible;
      impossible.failure = explanation.error().describe();
      return impossible;
    }
    ModelDiscrepancy found = discrepancy_of(*explanation);
    found.explained_asset_yaml = write_asset_(explanation->explained);
    return found;
  }

 private:
  AssetWriter write_asset_;
  mismatch::ExplainOptions options_;
};

}  // namespace

ModelDiscrepancy discrepancy_of(const mismatch::Explanation& explanation) {
  ModelDiscrepancy found;
  found.analysed = true;
  found.verdict = static_cast<DiscrepancyVerdict>(explanation.verdict);
  found.p_value = explanation.p_value;
  found.explained_share = explanation.explained_share;
  for (const mismatch::Location& place : explanation.location)
    found.location.push_back({place.element, place.probability, place.indistinguishable_from, place.evidence});
  for (const mismatch::FoundEffect& effect : explanation.effects) found.physics.push_back(physics_of(effect));
  for (const mismatch::ChannelComparison& channel : explanation.holdout.channels)
    found.holdout.push_back({channel.channel, channel.rms_before, channel.rms_after});
  found.summary = explanation.summary;
  found.next_test = explanation.next_test;
  found.explained = model_of(explanation.explained);
  return found;
}

std::shared_ptr<const Explainer> make_mismatch_explainer(AssetWriter write_asset,
                                                         const mismatch::ExplainOptions& options) {
  return std::make_shared<MismatchExplainer>(std::move(write_asset), options);
}

static_assert(EnumNames<DiscrepancyVerdict>::kNames == EnumNames<MismatchVerdict>::kNames);

}  // namespace sealwatch
