#include "services/health_assessment/signatures.hpp"

#include <algorithm>
#include <utility>

namespace sealwatch {
namespace {

/// Steady state of the test; symbols as in the header.
struct OperatingPoint {
  double dp, R, G_P, D, E, R_M, T_M, alpha_P;
  double q_h, omega_h, omega_plus, i_plus;
};

double parameter(const AssetConfig& asset, const char* name, double otherwise) {
  const auto found = asset.parameters.find(name);
  return found == asset.parameters.end() ? otherwise : found->second.value;
}

OperatingPoint operating_point(const AssetConfig& asset, const std::vector<Deviation>& deviations) {
  const auto measured = [&](const char* quantity, double otherwise) {
    const Deviation* deviation = find_deviation(deviations, quantity);
    return deviation != nullptr && deviation->judgement.value > 0.0 ? deviation->judgement.value : otherwise;
  };
  const double area = parameter(asset, "A_C", parameter(asset, "A_A", 1.0));
  OperatingPoint p{};
  p.dp = measured("load_pressure", parameter(asset, "phi", 1.0) / area);
  p.R = measured("leakage_resistance", parameter(asset, "R_CL", 1.0));
  p.G_P = measured("pump_slip", 1.0 / parameter(asset, "R_PL", 1.0));
  p.D = measured("shaft_drag", parameter(asset, "f_M", 0.0) + parameter(asset, "d_P", 0.0));
  p.E = measured("back_emf", parameter(asset, "Omega_M", 1.0));
  p.R_M = parameter(asset, "R_M", 1.0);
  p.T_M = parameter(asset, "T_M", p.E);
  p.alpha_P = parameter(asset, "alpha_P", 1.0);
  p.q_h = p.dp / p.R;
  p.omega_h = (p.q_h + p.G_P * p.dp) / p.alpha_P;
  p.omega_plus = (area * asset.pst.speed_m_s + p.q_h + p.G_P * p.dp) / p.alpha_P;
  p.i_plus = (p.alpha_P * p.dp + p.D * p.omega_plus) / p.T_M;
  return p;
}

std::vector<Signature> actuator_faults(const OperatingPoint& p, bool has_resistance) {
  const char* leakage = has_resistance ? "leakage_resistance" : "hold_decay_rate";
  const double friction_current = p.alpha_P / p.T_M;
  return {
      {FaultKind::internal_leakage, "piston_seal", false, {{leakage, has_resistance ? -1.0 : 1.0}}},
      {FaultKind::friction,
       "piston",
       false,
       {{"friction_pressure", 1.0}, {"breakaway_pressure", 1.0}, {"load_free_current", friction_current}}},
      {FaultKind::friction, "piston", false, {{"breakaway_pressure", 1.0}}},
      {FaultKind::pump, "pump", false, {{"pump_slip", 1.0}}},
      {FaultKind::pump, "shaft", false, {{"shaft_drag", 1.0}, {"load_free_current", p.omega_plus / p.T_M}}},
      {FaultKind::load, "piston", true, {{"load_pressure", 1.0}}},
      {FaultKind::driver, "driver", false, {{"back_emf", 1.0}}},
  };
}

Signature pressure_bias(const OperatingPoint& p, const char* element) {
  return {FaultKind::sensor,
          element,
          true,
          {{"load_pressure", 1.0},
           {"leakage_resistance", 1.0 / p.q_h},
           {"pump_slip", -p.G_P / p.dp},
           {"shaft_drag", -p.alpha_P / p.omega_plus},
           {"load_free_current", -p.alpha_P / p.T_M}}};
}

std::vector<Signature> sensor_faults(const OperatingPoint& p) {
  return {
      {FaultKind::sensor,
       "sensor:flow",
       true,
       {{"leakage_resistance", -p.R}, {"pump_slip", -p.q_h / p.dp}, {"flow_gain", 1.0}, {"delivery_ratio", 1.0}}},
      {FaultKind::sensor, "sensor:flow", true, {{"leakage_resistance", -p.R / p.q_h}, {"pump_slip", -1.0 / p.dp}}},
      pressure_bias(p, "sensor:pressure_a"),
      pressure_bias(p, "sensor:pressure_b"),
      pressure_bias(p, "sensor:pressure_differential"),
      {FaultKind::sensor,
       "sensor:shaft_speed",
       true,
       {{"pump_slip", p.alpha_P * p.omega_h / p.dp},
        {"shaft_drag", -p.D},
        {"back_emf", -p.E},
        {"delivery_ratio", -1.0}}},
      {FaultKind::sensor,
       "sensor:motor_current",
       true,
       {{"shaft_drag", p.T_M * p.i_plus / p.omega_plus},
        {"back_emf", -p.R_M * p.i_plus / p.omega_plus},
        {"load_free_current", p.i_plus}}},
      {FaultKind::sensor, "sensor:position", true, {{"flow_gain", -1.0}, {"velocity_gain", -1.0}}},
      {FaultKind::sensor, "sensor:velocity", true, {{"velocity_gain", 1.0}}},
  };
}

}  // namespace

std::vector<Signature> fault_signatures(const AssetConfig& asset, const std::vector<Deviation>& deviations,
                                        const std::set<std::string>& channels, const std::set<std::string>& suspects,
                                        bool failed) {
  const OperatingPoint point = operating_point(asset, deviations);
  std::vector<Signature> all = actuator_faults(point, find_deviation(deviations, "leakage_resistance") != nullptr);
  for (Signature& signature : sensor_faults(point))
    if (channels.count(signature.element.substr(std::string("sensor:").size())) != 0)
      all.push_back(std::move(signature));
  std::erase_if(all, [&](const Signature& signature) {
    if (failed && signature.kind != FaultKind::sensor) return false;
    return std::none_of(signature.moves.begin(), signature.moves.end(),
                        [&](const auto& move) { return find_deviation(deviations, move.first) != nullptr; });
  });
  for (const std::string& suspect : suspects)
    if (std::none_of(all.begin(), all.end(), [&](const Signature& s) { return s.element == suspect; }))
      all.push_back({FaultKind::sensor, suspect, true, {}});
  return all;
}

}  // namespace sealwatch
