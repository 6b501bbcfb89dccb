#include "services/common/model/plants/eha/estimation/chamber_pressure.hpp"

#include <cmath>

namespace sealwatch {

SimulatedPressure simulate_pressure_a(const CylinderSignals& signals, double conductance, double compressibility) {
  const bool use_velocity = !signals.velocity_m_s.empty();
  const double lag_s = use_velocity ? signals.velocity_lag_s : signals.position_lag_s;
  const std::vector<double> travel =
      use_velocity ? integrate(signals.time_s, signals.velocity_m_s) : signals.position_m;
  const std::vector<double> volume = integrate(signals.time_s, signals.flow_m3_s);
  const double travel_noise = use_velocity ? signals.velocity_noise_std : 0.0;
  SimulatedPressure result{.pressure_a_Pa = {signals.pressure_a_Pa.front()},
                           .standard_deviation_Pa = {std::sqrt(2.0) * signals.pressure_noise_std}};
  double drift_variance = signals.pressure_noise_std * signals.pressure_noise_std;
  for (std::size_t k = 1; k < signals.time_s.size(); ++k) {
    const double h = signals.time_s[k] - signals.time_s[k - 1];
    const double stiffness =
        1.0 / (compressibility * (signals.dead_volume_m3 + signals.area_m2 * signals.position_m[k]));
    const auto net = [&](std::size_t j) {
      return volume[j] + (signals.flow_lag_s - lag_s) * signals.flow_m3_s[j] - signals.area_m2 * travel[j];
    };
    const auto pressure_b = [&](std::size_t j) { return signals.pressure_a_Pa[j] - signals.pressure_difference_Pa[j]; };
    const double half = 0.5 * h * stiffness * conductance;  // implicit midpoint rule
    const double p = result.pressure_a_Pa.back();
    result.pressure_a_Pa.push_back(
        ((1.0 - half) * p + half * (pressure_b(k) + pressure_b(k - 1)) + stiffness * (net(k) - net(k - 1))) /
        (1.0 + half));
    const double decay = (1.0 - half) / (1.0 + half);
    drift_variance = decay * decay * drift_variance +
                     std::pow(stiffness * h, 2) *
                         (std::pow(signals.flow_noise_std, 2) + std::pow(signals.area_m2 * travel_noise, 2));
    const double white = stiffness * std::hypot((signals.flow_lag_s - lag_s) * signals.flow_noise_std,
                                                use_velocity ? 0.0 : signals.area_m2 * signals.position_noise_std);
    result.standard_deviation_Pa.push_back(
        std::sqrt(drift_variance + white * white + std::pow(signals.pressure_noise_std, 2)));
  }
  return result;
}

}  // namespace sealwatch
