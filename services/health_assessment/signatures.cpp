#include "services/health_assessment/signatures.hpp"

#include <algorithm>
#include <utility>

#include "sealwatch/model/plant_description.hpp"

namespace sealwatch {
namespace {

/// Steady state of the test; symbols as in the header.
struct OperatingPoint {
  double dp, R, G_P, D, E, R_M, T_M, alpha_P;
  double q_h, omega_h, omega_plus, i_plus;
};

/// What the asset says of the parameter with that role, where its plant has one.
double parameter(const AssetConfig& asset, ParameterRole role, double otherwise) {
  const ParameterDescription* described = plant_or_default(asset.model).find_parameter(role);
  if (described == nullptr) return otherwise;
  const auto found = asset.parameters.find(described->name);
  return found == asset.parameters.end() ? otherwise : found->second.value;
}

double mean_load(const AssetConfig& asset) {
  const auto found = asset.parameters.find(plant_or_default(asset.model).load_parameter);
  return found == asset.parameters.end() ? 1.0 : found->second.value;
}

OperatingPoint operating_point(const AssetConfig& asset, const std::vector<Deviation>& deviations) {
  const auto measured = [&](const char* quantity, double otherwise) {
    const Deviation* deviation = find_deviation(deviations, quantity);
    return deviation != nullptr && deviation->judgement.value > 0.0 ? deviation->judgement.value : otherwise;
  };
  const double area = parameter(asset, ParameterRole::area_up, 1.0);
  OperatingPoint p{};
  p.dp = measured("load_pressure", mean_load(asset) / area);
  p.R = measured("leakage_resistance", parameter(asset, ParameterRole::seal_leakage, 1.0));
  p.G_P = measured("pump_slip", 1.0 / parameter(asset, ParameterRole::pump_leakage, 1.0));
  p.D = measured("shaft_drag", parameter(asset, ParameterRole::motor_friction, 0.0) +
                                   parameter(asset, ParameterRole::pump_friction, 0.0));
  p.E = measured("back_emf", parameter(asset, ParameterRole::back_emf, 1.0));
  p.R_M = parameter(asset, ParameterRole::motor_resistance, 1.0);
  p.T_M = parameter(asset, ParameterRole::torque_constant, p.E);
  p.alpha_P = parameter(asset, ParameterRole::displacement, 1.0);
  p.q_h = p.dp / p.R;
  p.omega_h = (p.q_h + p.G_P * p.dp) / p.alpha_P;
  p.omega_plus = (area * asset.pst.speed_m_s + p.q_h + p.G_P * p.dp) / p.alpha_P;
  p.i_plus = (p.alpha_P * p.dp + p.D * p.omega_plus) / p.T_M;
  return p;
}

struct ActuatorFault {
  FaultKind kind;
  SiteKind where;  ///< the element is that of the plant's first such site
  bool either_sign;
  std::map<std::string, double> moves;
};

std::vector<ActuatorFault> actuator_faults(const OperatingPoint& p, bool has_resistance) {
  const char* leakage = has_resistance ? "leakage_resistance" : "hold_decay_rate";
  const double friction_current = p.alpha_P / p.T_M;
  return {
      {FaultKind::internal_leakage, SiteKind::seal_leakage, false, {{leakage, has_resistance ? -1.0 : 1.0}}},
      {FaultKind::friction,
       SiteKind::piston_force,
       false,
       {{"friction_pressure", 1.0}, {"breakaway_pressure", 1.0}, {"load_free_current", friction_current}}},
      {FaultKind::friction, SiteKind::piston_force, false, {{"breakaway_pressure", 1.0}}},
      {FaultKind::pump, SiteKind::pump_slip, false, {{"pump_slip", 1.0}}},
      {FaultKind::pump,
       SiteKind::shaft_torque,
       false,
       {{"shaft_drag", 1.0}, {"load_free_current", p.omega_plus / p.T_M}}},
      {FaultKind::load, SiteKind::piston_force, true, {{"load_pressure", 1.0}}},
      {FaultKind::driver, SiteKind::voltage_command, false, {{"back_emf", 1.0}}},
  };
}

using Moves = std::map<std::string, double>;

Moves of_pressure_bias(const OperatingPoint& p) {
  return {{"load_pressure", 1.0},
          {"leakage_resistance", 1.0 / p.q_h},
          {"pump_slip", -p.G_P / p.dp},
          {"shaft_drag", -p.alpha_P / p.omega_plus},
          {"load_free_current", -p.alpha_P / p.T_M}};
}

std::vector<std::pair<ChannelRole, Moves>> moves_of_sensors(const OperatingPoint& p) {
  return {
      {ChannelRole::flow,
       {{"leakage_resistance", -p.R}, {"pump_slip", -p.q_h / p.dp}, {"flow_gain", 1.0}, {"delivery_ratio", 1.0}}},
      {ChannelRole::flow, {{"leakage_resistance", -p.R / p.q_h}, {"pump_slip", -1.0 / p.dp}}},
      {ChannelRole::pressure_up, of_pressure_bias(p)},
      {ChannelRole::pressure_down, of_pressure_bias(p)},
      {ChannelRole::pressure_difference, of_pressure_bias(p)},
      {ChannelRole::shaft_speed,
       {{"pump_slip", p.alpha_P * p.omega_h / p.dp},
        {"shaft_drag", -p.D},
        {"back_emf", -p.E},
        {"delivery_ratio", -1.0}}},
      {ChannelRole::current,
       {{"shaft_drag", p.T_M * p.i_plus / p.omega_plus},
        {"back_emf", -p.R_M * p.i_plus / p.omega_plus},
        {"load_free_current", p.i_plus}}},
      {ChannelRole::stroke, {{"flow_gain", -1.0}, {"velocity_gain", -1.0}}},
      {ChannelRole::speed, {{"velocity_gain", 1.0}}},
  };
}

}  // namespace

std::vector<Signature> fault_signatures(const AssetConfig& asset, const std::vector<Deviation>& deviations,
                                        const std::set<std::string>& channels, const std::set<std::string>& suspects,
                                        bool failed) {
  const OperatingPoint point = operating_point(asset, deviations);
  const PlantDescription& plant = plant_or_default(asset.model);
  const std::string stroke_sensor = "sensor:" + channel_name(plant, ChannelRole::stroke);
  std::vector<Signature> all;
  for (auto& [kind, where, either_sign, moves] :
       actuator_faults(point, find_deviation(deviations, "leakage_resistance") != nullptr))
    if (const auto site = std::ranges::find(plant.sites, where, &Site::kind); site != plant.sites.end())
      all.push_back({kind, std::string(site->element), either_sign, std::move(moves), true});
  for (auto& [role, moves] : moves_of_sensors(point))
    if (const std::string channel = channel_name(plant, role); channels.contains(channel))
      all.push_back({FaultKind::sensor, "sensor:" + channel, true, std::move(moves), role == ChannelRole::stroke});
  std::erase_if(all, [&](const Signature& signature) {
    if (failed && signature.kind != FaultKind::sensor) return false;
    return std::none_of(signature.moves.begin(), signature.moves.end(),
                        [&](const auto& move) { return find_deviation(deviations, move.first) != nullptr; });
  });
  for (const std::string& suspect : suspects)
    if (std::none_of(all.begin(), all.end(), [&](const Signature& s) { return s.element == suspect; }))
      all.push_back({FaultKind::sensor, suspect, true, {}, suspect == stroke_sensor});
  return all;
}

}  // namespace sealwatch
