// Integration of stiff equations dy/dt = f(t, y) by Boost.Odeint's Rosenbrock method of order 4 (Hairer and Wanner,
// Solving Ordinary Differential Equations II, section IV.7): L-stable, step control, dense output. States scaled to
// about 1. Jacobian by forward differences. As for every Rosenbrock method the order falls where fast states follow a
// curved function of time; the bench's references are straight, and a test compares its results with those of a
// tolerance a thousand times finer.
//
// This header and its source are C++17: the matrices under Odeint (Boost 1.74) do not compile as C++20.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace sealwatch::bench {

/// dy/dt at (t, y), as many numbers as there are states.
using Rates = std::function<void(double time, const double* state, double* rates)>;
using TakeSample = std::function<void(double time, const std::vector<double>& state)>;

struct StepControl {
  double tolerance = 1e-6;  ///< of a step: absolute and relative, each state
  double first_step = 1e-5;
  double largest_step = 0.5;
  std::size_t most_steps = 100000;  ///< a test takes some thousand
};

/// Moves `state` from `start` to `end`, over which f must be smooth, and gives the state at each of the increasing
/// `times` within (start, end]. Returns the number of steps. Throws std::runtime_error when no step size will do.
std::size_t integrate_rosenbrock(const Rates& f, std::vector<double>& state, double start, double end,
                                 const std::vector<double>& times, const TakeSample& take, const StepControl& control);

}  // namespace sealwatch::bench
