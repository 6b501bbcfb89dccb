#include "services/prognostic_assessment/judge_estimate.hpp"

#include <cmath>

#include "sealwatch/model/plant_description.hpp"
#include "services/common/text/numbers.hpp"
#include "services/common/text/readable.hpp"

namespace sealwatch::prognostic_assessment {
namespace {

const EstimatedParameter* what_wears(const FitReport& fit, std::string_view name) {
  for (const EstimatedParameter& parameter : fit.parameters)
    if (parameter.name == name && parameter.free && std::isfinite(parameter.value) &&
        std::isfinite(parameter.std_error))
      return &parameter;
  return nullptr;
}

/// A fit that did not converge, or cannot tell a value from twice itself, ends near where it began: that is no estimate.
bool tells(const FitReport& fit, std::string_view name) {
  constexpr double kLargestRelativeError = 0.5;
  const EstimatedParameter* worn = what_wears(fit, name);
  return worn && fit.converged && worn->std_error <= kLargestRelativeError * std::abs(worn->value);
}

const FitReport* choose(const std::vector<FitReport>& fits, std::string_view name) {
  for (const FitReport& fit : fits)
    if (fit.admissible && what_wears(fit, name)) return &fit;
  for (const FitReport& fit : fits)
    if (tells(fit, name)) return &fit;
  return nullptr;
}

void append(std::vector<std::string>& reasons, const std::vector<std::string>& more, const std::string& otherwise) {
  if (more.empty()) reasons.push_back(otherwise);
  reasons.insert(reasons.end(), more.begin(), more.end());
}

void take_value(LeakageEstimate& estimate, const FitReport& fit, const EstimatedParameter& worn, bool positive) {
  estimate.estimated = true;
  estimate.chosen_model = fit.model;
  estimate.resistance_Pa_s_m3 = worn.value;
  estimate.resistance_std_Pa_s_m3 = worn.std_error;
  estimate.unit = worn.unit;
  if (!fit.admissible) append(estimate.reasons, fit.reasons, "the fit of model " + fit.model + " is not admissible");
  if (positive && worn.value <= 0.0)
    estimate.reasons.push_back(worn.name + " = " + text::with_unit(worn.value, worn.unit) + " is not positive");
}

void take_condition(LeakageEstimate& estimate, const AssetConfig& asset, const PlantDescription& plant,
                    double largest_condition_std) {
  if (!asset.condition) {
    estimate.reasons.emplace_back(plant.condition
                                      ? "the asset file gives no seal resistances: the seal condition is not defined"
                                      : "the asset file has no section `condition`: its condition is not defined");
    return;
  }
  const ConditionSetting& scale = *asset.condition;
  estimate.condition_known = estimate.estimated && (!scale.is_positive() || estimate.resistance_Pa_s_m3 > 0.0);
  if (!estimate.condition_known) return;
  estimate.condition = scale.condition(estimate.resistance_Pa_s_m3);
  estimate.condition_std = scale.condition_std(estimate.resistance_Pa_s_m3, estimate.resistance_std_Pa_s_m3);
  if (estimate.condition_std > largest_condition_std)
    estimate.reasons.push_back("the standard error of the " + std::string(plant.condition ? "seal " : "") +
                               "condition, " + text::condition_in_percent(estimate.condition_std) + ", is above " +
                               text::condition_in_percent(largest_condition_std));
}

}  // namespace

LeakageEstimate judge_estimate(const AssetConfig& asset, const HealthReport& health, std::vector<FitReport> fits,
                               double largest_condition_std) {
  LeakageEstimate estimate;
  estimate.asset_id = asset.asset_id;
  if (!health.admissible_for_prognosis)
    append(estimate.reasons, health.inadmissible_reasons,
           "health assessment found the test inadmissible for prognosis");
  const auto known = find_plant(asset.model);
  const PlantDescription plant = known ? **known : PlantDescription{};
  estimate.parameter = asset.condition ? asset.condition->parameter : plant.wear_parameter;
  const bool positive = !asset.condition || asset.condition->is_positive();
  if (const FitReport* fit = choose(fits, estimate.parameter)) {
    take_value(estimate, *fit, *what_wears(*fit, estimate.parameter), positive);
  } else {
    estimate.reasons.push_back(estimate.parameter.empty()
                                   ? "neither the asset file nor its plant says which parameter wears"
                                   : "no fit gave an estimate of " + estimate.parameter);
    for (const FitReport& fit_without : fits)
      for (const std::string& reason : fit_without.reasons)
        estimate.reasons.push_back(fit_without.model + ": " + reason);
  }
  take_condition(estimate, asset, plant, largest_condition_std);
  if (!health.header.event_time_known)
    estimate.reasons.push_back("the recording has no start time: its place in the history is not known");
  estimate.used_for_forecast = estimate.reasons.empty();
  estimate.fits = std::move(fits);
  return estimate;
}

}  // namespace sealwatch::prognostic_assessment
