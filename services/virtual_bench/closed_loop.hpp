// The actuator with its controller and the low-passes of its sensors, integrated over one test.
//
// State: the nine of plant `eha`, the controller's integral part U [V], one low-pass y for each sensor with a time
// constant and one for each that lags, and the hidden states of the asset's laws. Integrator: Boost.Odeint's Rosenbrock
// method of order 4 (L-stable, step control, dense output), started anew at every corner of the reference. The
// estimator has its own integrator, step control and sensor code.
#pragma once

#include <vector>

#include "sealwatch/core/result.hpp"
#include "sealwatch/model/eha.hpp"
#include "services/virtual_bench/bench_physics.hpp"
#include "services/virtual_bench/controller.hpp"
#include "services/virtual_bench/profile.hpp"
#include "services/virtual_bench/sensors.hpp"

namespace sealwatch::bench {

struct ClosedLoop {
  EhaParameters<double> parameters;
  BenchPhysics physics = {};
  ControllerSetting controller = {};
  std::vector<Sensor> sensors;
  double settling_time_s = 20.0;     ///< held by the controller at the start before the test: the circuit comes to rest
  double relative_tolerance = 1e-6;  ///< of a step, each state relative to its usual size
};

/// Low-passed values, without noise, of each sensor at each of `times_s` (increasing, within the profile).
[[nodiscard]] Result<std::vector<std::vector<double>>> integrate(const ClosedLoop& loop, const Profile& profile,
                                                                 const std::vector<double>& times_s);

}  // namespace sealwatch::bench
