// Motion of the piston in a partial stroke test as the position controller gives it, in closed form.
//
//   dx/dt = v,   tau_v dv/dt = k_pos (r_x - x) - v
//
//   r_x    reference, straight pieces over time [m]       k_pos  gain of the position controller [1/s]
//   tau_v  lag of the velocity loop [s]
//
// On a piece r_x = r_0 + w t, with the roots s_1, s_2 of tau_v s^2 + s + k_pos = 0 (real: 4 k_pos tau_v < 1),
//
//   x(t) = r_0 + w (t - 1/k_pos) + c_1 exp(s_1 t) + c_2 exp(s_2 t),   v and a by differentiation
//
// c_1, c_2 from x and v at the beginning of the piece. Gains: docs/model.md; the velocity loop's 20 ms are
// those of the bench's loop for small moves.
#pragma once

#include <vector>

#include "services/virtual_bench/profile.hpp"

namespace sealwatch::verification {

struct MotionSample {
  double position_m = 0.0;
  double velocity_m_s = 0.0;
  double acceleration_m_s2 = 0.0;
};

struct StrokeLoop {
  double k_pos_1_s = 3.0;
  double velocity_lag_s = 0.02;
};

/// At t = 0, step, 2 step, ... `count` samples.
[[nodiscard]] std::vector<MotionSample> stroke_motion(const bench::Profile& profile, double step_s, std::size_t count,
                                                      const StrokeLoop& loop = {});

}  // namespace sealwatch::verification
