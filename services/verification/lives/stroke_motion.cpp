#include "services/verification/lives/stroke_motion.hpp"

#include <cassert>
#include <cmath>

namespace sealwatch::verification {
namespace {

/// The solution on one straight piece of the reference.
class Piece {
 public:
  Piece(const StrokeLoop& loop, double reference_m, double speed_m_s, const MotionSample& begin)
      : reference_m_(reference_m - speed_m_s / loop.k_pos_1_s), speed_m_s_(speed_m_s) {
    const double discriminant = 1.0 - 4.0 * loop.k_pos_1_s * loop.velocity_lag_s;
    assert(discriminant > 0.0);
    fast_1_s_ = (-1.0 - std::sqrt(discriminant)) / (2.0 * loop.velocity_lag_s);
    slow_1_s_ = (-1.0 + std::sqrt(discriminant)) / (2.0 * loop.velocity_lag_s);
    const double off_m = begin.position_m - reference_m_;
    const double off_m_s = begin.velocity_m_s - speed_m_s;
    fast_m_ = (off_m_s - slow_1_s_ * off_m) / (fast_1_s_ - slow_1_s_);
    slow_m_ = off_m - fast_m_;
  }

  [[nodiscard]] MotionSample at(double time_s) const {
    const double fast = fast_m_ * std::exp(fast_1_s_ * time_s);
    const double slow = slow_m_ * std::exp(slow_1_s_ * time_s);
    return {reference_m_ + speed_m_s_ * time_s + fast + slow, speed_m_s_ + fast_1_s_ * fast + slow_1_s_ * slow,
            fast_1_s_ * fast_1_s_ * fast + slow_1_s_ * slow_1_s_ * slow};
  }

 private:
  double reference_m_, speed_m_s_;
  double fast_1_s_ = 0.0, slow_1_s_ = 0.0;  // roots
  double fast_m_ = 0.0, slow_m_ = 0.0;      // c_1, c_2
};

}  // namespace

std::vector<MotionSample> stroke_motion(const bench::Profile& profile, double step_s, std::size_t count,
                                        const StrokeLoop& loop) {
  std::vector<MotionSample> motion;
  motion.reserve(count);
  MotionSample begin{.position_m = profile.start_m};
  double begin_s = 0.0;
  double reference_m = profile.start_m;
  for (const bench::ProfilePiece& stretch : profile.pieces) {
    const Piece piece(loop, reference_m, stretch.speed_m_s, begin);
    const double end_s = begin_s + stretch.duration_s;
    for (double t = static_cast<double>(motion.size()) * step_s; motion.size() < count && t < end_s;
         t = static_cast<double>(motion.size()) * step_s)
      motion.push_back(piece.at(t - begin_s));
    begin = piece.at(stretch.duration_s);
    begin_s = end_s;
    reference_m += stretch.speed_m_s * stretch.duration_s;
  }
  const Piece rest(loop, reference_m, 0.0, begin);
  while (motion.size() < count) motion.push_back(rest.at(static_cast<double>(motion.size()) * step_s - begin_s));
  return motion;
}

}  // namespace sealwatch::verification
