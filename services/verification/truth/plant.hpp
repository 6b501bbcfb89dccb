// The actuator of blind trials: the reference model's nine balances (docs/model.md) written out a second
// time, with places for hidden physics, the cascaded controller and sensor filters, integrated by the bench's own
// Rosenbrock method. Shares neither equations nor laws nor integrator with the estimator.
//
//   y = z, i, omega, p_1, p_2, p_A, p_B, v, x    voltage behind the driver, current, shaft speed, pressures, motion
//
// A line's resistance is solved for at every call: the flow q for which q = valve(D - loss(q)).
#pragma once

#include <string>
#include <vector>

#include "sealwatch/core/result.hpp"
#include "services/verification/truth/effects.hpp"
#include "services/verification/truth/parameters.hpp"
#include "services/virtual_bench/controller.hpp"
#include "services/virtual_bench/profile.hpp"

namespace sealwatch::bench {

using TruthState = std::array<double, 9>;
namespace truth_index {
enum TruthIndex : std::size_t { kVoltage, kCurrent, kShaft, kPort1, kPort2, kChamberA, kChamberB, kSpeed, kPosition };
}

/// Flow from the pump port into its chamber. [m3/s]
[[nodiscard]] double truth_valve_flow(double port, double chamber, double other_port, const TruthParameters& p,
                                      const LineLoss& line = {}, double cracking_relief = 0.0);

/// Flow into chamber A. [m3/s]
[[nodiscard]] double truth_inlet_flow(const TruthState& y, const TruthParameters& p, const TruthAdditions& additions);

[[nodiscard]] TruthState truth_rates(const TruthState& y, double command_V, const TruthParameters& p,
                                     const TruthAdditions& additions = {});

struct TruthSensor {
  std::string channel;
  double time_constant_s = 0.0;
  double extra_lag_s = 0.0;  ///< a second low-pass behind the first: the fault of a slow sensor
};

struct TruthTest {
  TruthParameters parameters;
  std::vector<HiddenEffect> effects = {};
  std::vector<TruthSensor> sensors = {};
  ControllerSetting controller = {};
  double settling_time_s = 20.0;
  double tolerance = 1e-6;
  /// From time 0 on the driver's command, linear between these; empty: the controller's. [V]
  std::vector<double> command_V = {};
  double command_step_s = 0.02;
};

/// What each sensor shows at each of `times_s` (increasing, from 0, within the profile), without noise.
[[nodiscard]] Result<std::vector<std::vector<double>>> run_truth(const TruthTest& test, const Profile& profile,
                                                                 const std::vector<double>& times_s);

}  // namespace sealwatch::bench
