#include "services/state_detection/indicators.hpp"

#include <cassert>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "sealwatch/config/judged_quantities.hpp"
#include "services/state_detection/phase_means.hpp"

namespace sealwatch {
namespace {

/// Temperature of the oil at the seabed, for which the asset's parameters hold (docs/health.md).
constexpr double kDesignTemperature_K = 277.15;

using Optional = std::optional<double>;

// Arithmetic that is absent as soon as one operand is.
template <class Operation>
Optional combine(const Optional& a, const Optional& b, Operation operation) {
  if (!a || !b) return std::nullopt;
  const double result = operation(*a, *b);
  if (!std::isfinite(result)) return std::nullopt;
  return result;
}
Optional operator+(const Optional& a, const Optional& b) {
  return combine(a, b, [](double x, double y) { return x + y; });
}
Optional operator-(const Optional& a, const Optional& b) {
  return combine(a, b, [](double x, double y) { return x - y; });
}
Optional operator*(const Optional& a, const Optional& b) {
  return combine(a, b, [](double x, double y) { return x * y; });
}
Optional operator/(const Optional& a, const Optional& b) {
  return combine(a, b, [](double x, double y) { return x / y; });
}
Optional absolute(const Optional& a) {
  if (!a) return std::nullopt;
  return std::abs(*a);
}

/// Reads the asset's parameters, the test's features and means by short names.
class Balances {
 public:
  Balances(const AssetConfig& asset, const TestFeatures& features, const TestWindow& window)
      : asset_(asset),
        features_(features),
        window_(window),
        plant_(plant_or_default(asset.model)),
        means_(window, plant_) {}

  [[nodiscard]] std::vector<Quantity> all() {
    hydraulic();
    electric();
    sensors();
    add("closing_time", parameter(ParameterRole::stroke) / absolute(means_.speed(Motion::retracting)));
    quality();
    return std::move(result_);
  }

 private:
  [[nodiscard]] Optional parameter(ParameterRole role) const {
    const ParameterDescription* described = plant_.find_parameter(role);
    if (described == nullptr) return std::nullopt;
    const auto found = asset_.parameters.find(described->name);
    if (found == asset_.parameters.end()) return std::nullopt;
    return found->second.value;
  }
  [[nodiscard]] Optional feature(const char* name) const { return feature_of(features_, name); }
  [[nodiscard]] Optional dp(Motion motion) const { return means_.pressure_difference(motion); }
  [[nodiscard]] Optional mean(ChannelRole channel, Motion motion) const { return means_.mean(channel, motion); }

  /// Of what drives the actuator, where that is a voltage.
  [[nodiscard]] Optional mean_voltage(Motion motion) const {
    const ChannelDescription* drive = plant_.find_channel(ChannelRole::drive);
    return drive != nullptr && drive->unit == "V" ? mean(ChannelRole::drive, motion) : std::nullopt;
  }

  void add(const char* name, const Optional& value) {
    const JudgedIndicator* const known = find_indicator(name);
    assert(known != nullptr);
    if (value && std::isfinite(*value)) result_.push_back({name, std::string(known->unit), *value, false, 0.0});
  }

  void hydraulic() {
    leakage_resistance_ = feature("leakage_resistance");
    if (leakage_resistance_ && !(*leakage_resistance_ > 0.0)) leakage_resistance_.reset();  // noise about no flow
    add("leakage_resistance", leakage_resistance_);
    add("friction_pressure", feature("friction_pressure"));
    add("breakaway_pressure", feature("breakaway_pressure"));
    load_pressure_ = (feature("running_pressure_out") + feature("running_pressure_back")) / Optional(2.0);
    add("load_pressure", load_pressure_);
    add("hold_decay_rate", feature("hold_decay") / absolute(feature("hold_pressure")));
    const Optional delivered = parameter(ParameterRole::displacement) * mean(ChannelRole::shaft_speed, Motion::holding);
    add("pump_slip", (delivered - mean(ChannelRole::flow, Motion::holding)) / dp(Motion::holding));
  }

  void electric() {
    const Optional current = mean(ChannelRole::current, Motion::extending);
    const Optional speed = mean(ChannelRole::shaft_speed, Motion::extending);
    const Optional torque = parameter(ParameterRole::torque_constant) * current;
    add("shaft_drag", (torque - parameter(ParameterRole::displacement) * dp(Motion::extending)) / speed);
    const Optional voltage = mean_voltage(Motion::extending);
    add("back_emf", (voltage - parameter(ParameterRole::motor_resistance) * current) / speed);
    const Optional load_current =
        parameter(ParameterRole::displacement) * load_pressure_ / parameter(ParameterRole::torque_constant);
    add("load_free_current", feature("peak_current") - absolute(load_current));
  }

  void sensors() {
    const Optional up = means_.speed_from_position(Motion::extending);
    const Optional down = means_.speed_from_position(Motion::retracting);
    const Optional flow_up = mean(ChannelRole::flow, Motion::extending);
    const Optional flow = flow_up - mean(ChannelRole::flow, Motion::retracting);
    const Optional leakage = (dp(Motion::extending) - dp(Motion::retracting)) / leakage_resistance_;
    const Optional area = parameter(ParameterRole::area_up);
    add("flow_gain", (flow - leakage) / (area * (up - down)));
    const Optional speed =
        mean(ChannelRole::shaft_speed, Motion::extending) - mean(ChannelRole::shaft_speed, Motion::holding);
    add("delivery_ratio",
        (flow_up - mean(ChannelRole::flow, Motion::holding)) / (parameter(ParameterRole::displacement) * speed));
    const Optional velocity =
        mean(ChannelRole::speed, Motion::extending) - mean(ChannelRole::speed, Motion::retracting);
    add("velocity_gain", velocity / (up - down));
  }

  void quality() {
    add("fluid_temperature_deviation", feature("fluid_temperature") - Optional(kDesignTemperature_K));
    add("drive_saturation", feature("drive_saturation"));
    add("missing_share", window_.missing_share);
  }

  const AssetConfig& asset_;
  const TestFeatures& features_;
  const TestWindow& window_;
  const PlantDescription& plant_;
  PhaseMeans means_;
  Optional leakage_resistance_;
  Optional load_pressure_;
  std::vector<Quantity> result_;
};

}  // namespace

std::optional<double> feature_of(const TestFeatures& features, std::string_view name) {
  for (const Quantity& feature : features.features)
    if (feature.name == name) return feature.value;
  return std::nullopt;
}

std::vector<Quantity> condition_indicators(const AssetConfig& asset, const TestFeatures& features,
                                           const TestWindow& window) {
  return Balances(asset, features, window).all();
}

}  // namespace sealwatch
