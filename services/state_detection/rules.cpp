#include "services/state_detection/rules.hpp"

#include <algorithm>
#include <array>

#include "sealwatch/config/judged_quantities.hpp"
#include "sealwatch/model/plant_description.hpp"

namespace sealwatch {
namespace {

/// The valve must close its full stroke in this time (docs/health.md).
constexpr double kClosingTime_s = 60.0;
/// A ramp that is followed to the percent still measures a few percent long over its steady part.
constexpr double kClosingTolerance = 1.05;

/// Seal condition at which regions begin, as the share of the way from as new (theta 1) to the threshold that is left.
/// 25 % left: plan; 12.5 % left: act; none left: failed. In nine years of slow ageing the first is years ahead of the
/// last.
constexpr double kLeftAdvisory = 0.25;
constexpr double kLeftWarning = 0.125;

/// Relative residual of the nominal model [%]: 100 means that the model explains nothing of what the channel did. That
/// the datasheet does not describe the actuator is worth an advisory and no more: it endangers nothing by itself.
/// Beyond that the simulation is absurd, and somebody should look at the asset's file.
constexpr AlertLimits kNominalResidual_percent{50.0, 300.0, 1000.0};

/// Oil at the seabed is at 4 degC; its viscosity, and with it every laminar leakage, changes by about 5 % per kelvin.
constexpr AlertLimits kTemperatureDeviation_K{3.0, 6.0, 12.0};
/// Share of a test in which the drive stands at its limit.
constexpr AlertLimits kDriveSaturation{0.01, 0.05, 0.20};
/// Share of samples that had to be interpolated.
constexpr AlertLimits kMissingShare{0.01, 0.10, 0.30};

/// A lost channel (1) blinds the diagnosis, it does not endanger the function: advisory.
constexpr AlertLimits kLostChannel{1.0, 2.0, 3.0};

struct NamedRule {
  std::string_view quantity;
  BaselineRule rule;
};

// Tolerances: what is of no consequence for the function, or what the test's own variation explains.
constexpr std::array kRules = {
    NamedRule{"friction_pressure", {0.15, 3e4, Side::both}},    // three times a pressure sensor's noise
    NamedRule{"breakaway_pressure", {0.30, 2e5, Side::above}},  // one moment, not a mean; less is no fault
    NamedRule{"load_pressure", {0.40, 5e5, Side::both}},        // the load factor differs by +-20 % between tests
    NamedRule{"load_free_current", {0.30, 0.0, Side::above}},
    NamedRule{"leakage_resistance", {0.30, 0.0, Side::both}},
    NamedRule{"hold_decay_rate", {0.30, 0.02, Side::above}},  // 2 %/s: temperature and controller move pressures too
    NamedRule{"pump_slip", {0.30, 0.0, Side::both}},
    NamedRule{"shaft_drag", {0.20, 0.0, Side::both}},
    NamedRule{"back_emf", {0.04, 0.0, Side::both}},
    NamedRule{"flow_gain", {0.05, 0.0, Side::both}},
    NamedRule{"delivery_ratio", {0.05, 0.0, Side::both}},
    NamedRule{"velocity_gain", {0.05, 0.0, Side::both}},
};
/// A residual must grow by half before it means anything: it also carries the load's noise.
constexpr BaselineRule kResidualRule{0.5, 0.5, Side::above};

std::optional<AlertLimits> seal_limits(const ConditionSetting& seal) {
  const auto resistance = [&](double left) { return seal.value(seal.threshold + left * (1.0 - seal.threshold)); };
  return AlertLimits{resistance(kLeftAdvisory), resistance(kLeftWarning), resistance(0.0)};
}

AlertLimits condition_limits(double threshold) {
  const auto theta = [&](double left) { return threshold + left * (1.0 - threshold); };
  return {theta(kLeftAdvisory), theta(kLeftWarning), theta(0.0)};
}

}  // namespace

bool goes_by_leakage(const AssetConfig& asset) {
  const std::optional<ConditionSetting>& seal = plant_or_default(asset.model).condition;
  return asset.condition && seal && asset.condition->parameter == seal->parameter;
}

std::optional<double> whole_stroke_m(const AssetConfig& asset) {
  const ParameterDescription* described = plant_or_default(asset.model).find_parameter(ParameterRole::stroke);
  const auto stroke = described == nullptr ? asset.parameters.end() : asset.parameters.find(described->name);
  return stroke == asset.parameters.end() ? std::nullopt : std::optional(stroke->second.value);
}

double longest_closing_time_s(const AssetConfig& asset) {
  const std::optional<double> stroke_m = whole_stroke_m(asset);
  const double ramp_s = stroke_m && asset.pst.speed_m_s > 0.0 ? *stroke_m / asset.pst.speed_m_s : 0.0;
  return kClosingTolerance * std::max(kClosingTime_s, ramp_s);
}

std::optional<AlertLimits> fixed_limits(const AssetConfig& asset, const std::string& quantity) {
  if (const auto own = asset.alert_limits.find(quantity); own != asset.alert_limits.end()) return own->second;
  if (quantity == "leakage_resistance" && goes_by_leakage(asset)) return seal_limits(*asset.condition);
  if (quantity == "condition" && asset.condition) return condition_limits(asset.condition->threshold);
  if (quantity == "closing_time") {
    const double longest = longest_closing_time_s(asset);
    return AlertLimits{0.98 * longest, longest, 1.1 * longest};
  }
  if (quantity == "fluid_temperature_deviation") return kTemperatureDeviation_K;
  if (quantity == "drive_saturation") return kDriveSaturation;
  if (quantity == "missing_share") return kMissingShare;
  if (quantity.starts_with(kResidualQuantity)) return kNominalResidual_percent;
  if (quantity.starts_with(kChannelQuantity)) return kLostChannel;
  return std::nullopt;
}

std::optional<BaselineRule> baseline_rule(const AssetConfig& asset, std::string_view quantity) {
  // A seal with known resistances is judged on the way to its threshold; that it ages is no deviation.
  if (quantity == "leakage_resistance" && goes_by_leakage(asset)) return std::nullopt;
  if (quantity.starts_with(kResidualQuantity)) return kResidualRule;
  for (const NamedRule& named : kRules)
    if (named.quantity == quantity) return named.rule;
  return std::nullopt;
}

}  // namespace sealwatch
