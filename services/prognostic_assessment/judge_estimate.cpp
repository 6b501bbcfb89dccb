#include "services/prognostic_assessment/judge_estimate.hpp"

#include <cmath>

#include "sealwatch/forecast/words.hpp"

namespace sealwatch::prognostic_assessment {
namespace {

const EstimatedParameter* leakage_resistance(const FitReport& fit) {
  for (const EstimatedParameter& parameter : fit.parameters)
    if (parameter.name == "R_CL" && parameter.free && std::isfinite(parameter.value) &&
        std::isfinite(parameter.std_error))
      return &parameter;
  return nullptr;
}

/// A fit that did not converge, or cannot tell R_CL from twice itself, ends near where it began: that is no estimate.
bool tells(const FitReport& fit) {
  constexpr double kLargestRelativeError = 0.5;
  const EstimatedParameter* resistance = leakage_resistance(fit);
  return resistance && fit.converged && resistance->std_error <= kLargestRelativeError * std::abs(resistance->value);
}

const FitReport* choose(const std::vector<FitReport>& fits) {
  for (const FitReport& fit : fits)
    if (fit.admissible && leakage_resistance(fit)) return &fit;
  for (const FitReport& fit : fits)
    if (tells(fit)) return &fit;
  return nullptr;
}

void append(std::vector<std::string>& reasons, const std::vector<std::string>& more, const std::string& otherwise) {
  if (more.empty()) reasons.push_back(otherwise);
  reasons.insert(reasons.end(), more.begin(), more.end());
}

void take_resistance(LeakageEstimate& estimate, const FitReport& fit, const EstimatedParameter& resistance) {
  estimate.estimated = true;
  estimate.chosen_model = fit.model;
  estimate.resistance_Pa_s_m3 = resistance.value;
  estimate.resistance_std_Pa_s_m3 = resistance.std_error;
  if (!fit.admissible) append(estimate.reasons, fit.reasons, "the fit of model " + fit.model + " is not admissible");
  if (resistance.value <= 0.0)
    estimate.reasons.push_back("R_CL = " + forecast::three_digits(resistance.value) + " Pa s/m3 is not positive");
}

void take_condition(LeakageEstimate& estimate, const AssetConfig& asset, double largest_condition_std) {
  if (!asset.seal) {
    estimate.reasons.push_back("the asset file gives no seal resistances: the seal condition is not defined");
    return;
  }
  estimate.condition_known = estimate.estimated && estimate.resistance_Pa_s_m3 > 0.0;
  if (!estimate.condition_known) return;
  estimate.condition = asset.seal->condition(estimate.resistance_Pa_s_m3);
  estimate.condition_std = asset.seal->condition_std(estimate.resistance_std_Pa_s_m3);
  if (estimate.condition_std > largest_condition_std)
    estimate.reasons.push_back("the standard error of the seal condition, " +
                               forecast::condition_in_percent(estimate.condition_std) + ", is above " +
                               forecast::condition_in_percent(largest_condition_std));
}

}  // namespace

LeakageEstimate judge_estimate(const AssetConfig& asset, const HealthReport& health, std::vector<FitReport> fits,
                               double largest_condition_std) {
  LeakageEstimate estimate;
  estimate.asset_id = asset.asset_id;
  if (!health.admissible_for_prognosis)
    append(estimate.reasons, health.inadmissible_reasons,
           "health assessment found the test inadmissible for prognosis");
  if (const FitReport* fit = choose(fits)) {
    take_resistance(estimate, *fit, *leakage_resistance(*fit));
  } else {
    estimate.reasons.push_back("no fit gave an estimate of R_CL");
    for (const FitReport& fit_without : fits)
      for (const std::string& reason : fit_without.reasons)
        estimate.reasons.push_back(fit_without.model + ": " + reason);
  }
  take_condition(estimate, asset, largest_condition_std);
  if (!health.header.event_time_known)
    estimate.reasons.push_back("the recording has no start time: its place in the history is not known");
  estimate.used_for_forecast = estimate.reasons.empty();
  estimate.fits = std::move(fits);
  return estimate;
}

}  // namespace sealwatch::prognostic_assessment
