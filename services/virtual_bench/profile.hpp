// The reference that the bench's position controller follows: straight pieces over time.
#pragma once

#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/recording.hpp"

namespace sealwatch::bench {

struct ProfilePiece {
  double duration_s = 0.0;
  double speed_m_s = 0.0;  ///< of the reference; 0: hold
};

struct Profile {
  TestKind kind = TestKind::pst;
  double start_m = 0.0;  ///< where the piston rests before
  std::vector<ProfilePiece> pieces = {};
  double ramp_speed_m_s = 0.0;  ///< largest speed of the reference

  [[nodiscard]] double duration_s() const;
  /// The reference at `time_s`, its ends held outside.
  [[nodiscard]] double reference_m(double time_s) const;
};

/// A partial stroke test: rest 1 s, out, hold, back, hold.
[[nodiscard]] Profile pst_profile(const PstSetting& setting);
/// A move of the valve that the Master Control System commands: rest 1 s, ramp, hold 3 s.
[[nodiscard]] Profile move_profile(double start_m, double target_m, double speed_m_s, TestKind kind);

}  // namespace sealwatch::bench
