// The volume balance of chamber A as a local-level model (include/sealwatch/estimation/cylinder_circuit.hpp).
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/result.hpp"
#include "sealwatch/core/time_series.hpp"

namespace sealwatch {

/// One recording's channels as the balance needs them. SI units.
struct CylinderSignals {
  std::span<const double> time_s;
  std::span<const double> flow_m3_s;
  std::vector<double> pressure_difference_Pa;
  std::vector<double> pressure_a_Pa;     ///< empty when only the difference is recorded
  std::vector<double> position_m;        ///< recorded, or summed up from the velocity
  std::span<const double> velocity_m_s;  ///< empty when not recorded
  bool position_recorded = false;
  double area_m2 = 0.0;          ///< A_C
  double dead_volume_m3 = 0.0;   ///< V_0
  double bulk_modulus_Pa = 0.0;  ///< beta that the asset starts from; 0 when it has none
  double flow_noise_std = 0.0, pressure_noise_std = 0.0, position_noise_std = 0.0, velocity_noise_std = 0.0;
  double flow_lag_s = 0.0, pressure_lag_s = 0.0, position_lag_s = 0.0, velocity_lag_s = 0.0;
};

/// An Error whose rule says what is missing or unusable.
[[nodiscard]] Result<CylinderSignals> gather_cylinder_signals(const AssetConfig& asset, const TimeSeries& samples);

/// y_k = level_k + c_1 g1_k (+ c_2 g2_k) + white noise, level a random walk that starts anew where `restart`.
struct VolumeBalance {
  Eigen::MatrixXd columns;             ///< y, g1 and, with both pressures, g2; in m3, m3 Pa s/m3, m3 Pa
  std::vector<double> level_step_std;  ///< of the level from sample k-1 to k [m3]
  double white_std = 0.0;              ///< of one sample [m3]
  double g2_noise_std = 0.0;           ///< white noise of one sample of g2, from the pressure sensor [m3 Pa]
  std::vector<bool> restart;
};

[[nodiscard]] VolumeBalance make_volume_balance(const CylinderSignals& signals);

struct WhitenedBalance {
  /// The columns' one-step prediction errors over their standard deviation; rows where the level starts are zero.
  Eigen::MatrixXd innovations;
  /// How much of g2's sum of squares is pressure noise: left in, it would bias 1/beta towards zero.
  double noise_in_g2 = 0.0;
};

[[nodiscard]] WhitenedBalance whiten(const VolumeBalance& balance);

/// Running integral by the trapezoidal rule, 0 at the first sample.
[[nodiscard]] std::vector<double> integrate(std::span<const double> time_s, std::span<const double> values);

}  // namespace sealwatch
