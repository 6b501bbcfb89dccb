// A measured signal as the input of a simulation: what the sensor's lag and noise made of it is undone as far as it
// can.
//
//   u(t) = y(t) + tau dy/dt       y, dy/dt: a parabola fitted to the samples within 0.04 s of t
//
// tau: the sensor's time constant. The parabola halves the noise at 100 Hz.
#pragma once

#include <vector>

namespace sealwatch {

[[nodiscard]] std::vector<double> undo_sensor(const std::vector<double>& time_s, const std::vector<double>& values,
                                              double time_constant_s);

}  // namespace sealwatch
