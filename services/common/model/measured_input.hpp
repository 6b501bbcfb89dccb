// A measured signal as the input of a simulation: what the sensor's lag and noise made of it is undone as far as it
// can.
//
//   u(t) = y(t) + tau dy/dt       y, dy/dt: a parabola fitted to the samples within h of t
//
// tau: the sensor's time constant. h: the longest up to 0.16 s whose u agrees with those of all shorter ones within
// 1.8 standard errors, so that a corner of the signal is not rounded by more than the noise could. What noise is left drives
// the simulation, and friction that damps it there fits better than none. Source: Katkovnik, IEEE Transactions on Signal Processing 47 (1999) 2567
// (intersection of confidence intervals).
#pragma once

#include <vector>

namespace sealwatch {

struct SmoothedInput {
  std::vector<double> values;
  std::vector<double> slopes;  ///< per second
};
/// Value and slope at each sample of the parabola fitted to the samples within `reach_s` on both sides.
[[nodiscard]] SmoothedInput smoothed_input(const std::vector<double>& time_s, const std::vector<double>& values,
                                           double reach_s);

/// Slopes at the samples of the cubic spline through them, whose ends are straight.
[[nodiscard]] std::vector<double> spline_slopes(const std::vector<double>& time_s, const std::vector<double>& values);

/// A controller holds its output from one sample to the next. A course that is linear between the means of neighbours
/// has the same delay and the same area, and an integrator need not start anew at every sample.
[[nodiscard]] std::vector<double> means_of_neighbours(const std::vector<double>& held);

/// u at the samples; the noise is as signal/noise_floor.hpp estimates it.
[[nodiscard]] std::vector<double> undo_sensor(const std::vector<double>& time_s, const std::vector<double>& values,
                                              double time_constant_s);

}  // namespace sealwatch
