#include "services/virtual_bench/profile.hpp"

#include <algorithm>
#include <cmath>

namespace sealwatch::bench {
namespace {

constexpr double kRest_s = 1.0;      // recorded before the reference moves
constexpr double kMoveHold_s = 3.0;  // recorded after a move of the valve

}  // namespace

double Profile::duration_s() const {
  double sum = 0.0;
  for (const ProfilePiece& piece : pieces) sum += piece.duration_s;
  return sum;
}

double Profile::reference_m(double time_s) const {
  double reference = start_m;
  for (const ProfilePiece& piece : pieces) {
    reference += piece.speed_m_s * std::clamp(time_s, 0.0, piece.duration_s);
    time_s -= piece.duration_s;
  }
  return reference;
}

Profile pst_profile(const PstSetting& setting) {
  const double out_s = std::abs(setting.stroke_m) / setting.speed_m_s;
  const double speed = std::copysign(setting.speed_m_s, setting.stroke_m);
  return {.kind = TestKind::pst,
          .start_m = setting.start_m,
          .pieces = {{kRest_s, 0.0}, {out_s, speed}, {setting.hold_s, 0.0}, {out_s, -speed}, {setting.hold_s, 0.0}},
          .ramp_speed_m_s = setting.speed_m_s};
}

Profile move_profile(double start_m, double target_m, double speed_m_s, TestKind kind) {
  const double distance = target_m - start_m;
  return {.kind = kind,
          .start_m = start_m,
          .pieces = {{kRest_s, 0.0},
                     {std::abs(distance) / speed_m_s, std::copysign(speed_m_s, distance)},
                     {kMoveHold_s, 0.0}},
          .ramp_speed_m_s = speed_m_s};
}

}  // namespace sealwatch::bench
