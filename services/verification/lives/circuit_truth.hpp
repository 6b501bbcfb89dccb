// The truth of the Monte Carlo verification: a recorded partial stroke test of the cylinder circuit alone, in a
// fraction of a millisecond. It has its own equations' form, integrator and sensors: nothing of the estimator's.
//
//   motion      x, v, a of the reference's stroke in closed form (stroke_motion.hpp)
//   piston      dp = p_A - p_B = (phi (1 + Phi) + f_C v + m_C a) / A_C
//   circuit     (V_A/beta) dp_A/dt = q - A_C v - dp/R_CL,   V_A = V_0 + A_C x,   p_A = p_B + dp
//               valves open: pump ports and chambers are one volume V = V_A + V_B + 2 V_P that make-up fills,
//                 (V/beta) dp_B/dt = -(V_A + V_P)/beta d(dp)/dt + q_C(p_B),
//                 q_C = K_MU s ln(1 + exp((p_0 - p_B)/s)), s = 2e4 Pa
//               chamber A can empty only as far as the pilot lets it, against p_0 at the pump's suction port:
//                 q >= -c_D a_V open_pilot sqrt(2 (p_A - p_0)/rho),
//                 open_pilot = (1 + tanh(g_V (r_pilot (p_B - p_0) - (p_A - p_0))))/2;  where this binds, q is it
//   sensors     tau dy/dt = quantity - y, then noise and quantisation (services/virtual_bench/sensors.hpp)
//
// Neglected beside the nine-state bench: motor and driver (the motion is given), the opened valves' pressure drops (a
// few kPa, below the sensors' noise), cushions. p_B by Heun's method, half a sample a step at 50 Hz (10 ms; the fastest
// time constant, the pilot's, is 20 ms). The flow of a step is what its volume balance leaves, so oil is conserved to
// rounding whatever the step's error in p_B is; low-passes are exact for inputs that are straight (pressures) or
// constant (flow) over a step. Symbols: docs/model.md.
#pragma once

#include <cstdint>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/result.hpp"
#include "sealwatch/core/time_series.hpp"
#include "services/verification/lives/stroke_motion.hpp"
#include "services/virtual_bench/sensors.hpp"

namespace sealwatch::verification {

/// Channels that the cylinder circuit needs and that a truth records.
[[nodiscard]] std::vector<std::string> circuit_channels();

class CircuitTruth {
 public:
  /// The asset's own partial stroke test. An Error for an asset of another model, or one that cannot do this test.
  [[nodiscard]] static Result<CircuitTruth> make(const AssetConfig& asset, double sample_rate_Hz,
                                                 double longest_step_s = 0.010);

  /// One test: leakage resistance R_CL [Pa s/m3], load factor Phi [1], seed of the sensors' noise. Thread-safe.
  [[nodiscard]] TimeSeries simulate(double resistance_Pa_s_m3, double load_factor, std::uint64_t noise_seed) const;
  /// The same without noise, for tests of the generator itself.
  [[nodiscard]] TimeSeries simulate_without_noise(double resistance_Pa_s_m3, double load_factor) const;

 private:
  struct Circuit {
    double A_C = 0.0, V_0 = 0.0, V_P = 0.0, x_C = 0.0, beta = 0.0, m_C = 0.0, f_C = 0.0, phi = 0.0;
    double p_0 = 0.0, K_MU = 0.0, g_V = 0.0, r_pilot = 0.0;
    double valve = 0.0;  ///< c_D a_V sqrt(2/rho)
  };
  /// What differs from test to test.
  struct Load {
    double conductance = 0.0;  ///< 1/R_CL
    double factor = 1.0;       ///< 1 + Phi
  };

  CircuitTruth() = default;
  void prepare_motion();
  [[nodiscard]] double pressure_difference(std::size_t step, const Load& load) const;
  [[nodiscard]] double return_pressure_rate(std::size_t step, double p_B, const Load& load) const;
  /// Each channel behind its sensor's lag.
  [[nodiscard]] std::vector<std::vector<double>> low_passed(const Load& load) const;

  Circuit circuit_;
  double step_s_ = 0.0;
  std::size_t steps_per_sample_ = 1;
  std::size_t samples_ = 0;
  double sample_rate_Hz_ = 0.0;
  std::vector<MotionSample> motion_;               ///< at each step
  std::vector<double> jerk_m_s3_;                  ///< at each step
  std::vector<bench::Sensor> sensors_;             ///< in the order of circuit_channels()
  std::vector<double> position_m_, velocity_m_s_;  ///< behind their sensors' lag, at each sample
};

}  // namespace sealwatch::verification
