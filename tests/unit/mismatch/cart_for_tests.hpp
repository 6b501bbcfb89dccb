// Recordings of a cart on a spring that a voice coil pushes, by the midpoint rule, which shares nothing with the
// simulation.
#pragma once

#include <cmath>
#include <random>
#include <string>
#include <utility>

#include "sealwatch/core/recording.hpp"

namespace sealwatch {

struct CartTruth {
  double spring_N_m = 1000.0;
  double friction_N = 0.0;  ///< Coulomb
  double cubic_drag_N_s3_m3 = 0.0;
  double fades_by = 0.0;  ///< share of the coil's force that is lost a centimetre from the middle, as the square
};

inline Recording recorded_cart(const std::string& name, const CartTruth& truth, unsigned seed) {
  constexpr double kStep_s = 1e-5, kSample_s = 5e-3, kDuration_s = 10.0;
  constexpr double kMass_kg = 2.0, kDrag_N_s_m = 5.0, kForce_N_A = 12.1;
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 2e-5);
  std::uniform_real_distribution<double> wait(0.1, 1.0), level(-6.0, 6.0);
  Recording recording;
  recording.recording_id = name;
  Series current{"current", "A", 0.0, {}}, position{"position", "m", 2e-5, {}};
  recording.samples.input_hold = true;
  const long each = std::lround(kSample_s / kStep_s), steps = std::lround(kDuration_s / kStep_s);
  double x = 0.0, v = 0.0, held_A = 0.0, next_s = wait(random);
  for (long step = 0; step <= steps; ++step) {
    const double t = static_cast<double>(step) * kStep_s;
    if (step % each == 0) {
      if (t >= next_s) {
        held_A = level(random);
        next_s += wait(random);
      }
      recording.samples.time_s.push_back(t);
      current.values.push_back(held_A);
      position.values.push_back(x + noise(random));
    }
    const auto acceleration = [&](double at, double speed) {
      const double force_N = kForce_N_A * (1.0 - truth.fades_by * std::pow(at / 0.01, 2)) * held_A;
      return (force_N - kDrag_N_s_m * speed - truth.spring_N_m * at - truth.friction_N * std::tanh(speed / 1e-3) -
              truth.cubic_drag_N_s3_m3 * speed * speed * speed) /
             kMass_kg;
    };
    const double middle = v + 0.5 * kStep_s * acceleration(x, v);
    v += kStep_s * acceleration(x + 0.5 * kStep_s * v, middle);
    x += kStep_s * middle;
  }
  recording.samples.channels = {std::move(current), std::move(position)};
  return recording;
}

}  // namespace sealwatch
