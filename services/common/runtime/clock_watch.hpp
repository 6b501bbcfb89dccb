// Whether this machine's clock was set while the service ran, seen against the steady clock, which nobody sets:
//
//   offset = now - steady,  a step = offset that changes by more than 1 s from one look to the next
//
// A step stands until the clock is back where it was, or for an hour in which there was no other. A machine that slept
// shows one too: the steady clock stops with it. Of a step before the start is known that the clock is behind what was
// written: it was set back by that much at least.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>
#include <optional>

#include "sealwatch/core/time.hpp"

namespace sealwatch {

class ClockWatch {
 public:
  using Steady = std::chrono::nanoseconds;  ///< since some fixed moment

  void begin(UtcTime last_written, UtcTime now, Steady steady) {
    offset_ = now.nanoseconds - steady.count();
    const double behind_s = static_cast<double>(last_written.nanoseconds - now.nanoseconds) * 1e-9;
    if (behind_s <= kStep_s) return;
    standing_s_ = -behind_s;
    since_ = steady;
    was_before_ = true;
  }
  /// True when the step that stands is another than at the last look.
  bool look(UtcTime now, Steady steady) {
    const std::int64_t offset = now.nanoseconds - steady.count();
    const double step_s = offset_ ? static_cast<double>(offset - *offset_) * 1e-9 : 0.0;
    offset_ = offset;
    const double before_s = standing_s_;
    if (std::abs(step_s) > kStep_s) {
      standing_s_ += step_s;
      since_ = steady;
    }
    const bool is_made_up = was_before_ && standing_s_ > -kStep_s;
    if (std::abs(standing_s_) <= kStep_s || is_made_up || steady - since_ > kStands) {
      standing_s_ = 0.0;
      was_before_ = false;
    }
    return standing_s_ != before_s;
  }
  /// By how much the clock was set [s], forward positive; nothing where no step stands.
  [[nodiscard]] std::optional<double> step_s() const {
    return standing_s_ != 0.0 ? std::optional(standing_s_) : std::nullopt;
  }

 private:
  static constexpr double kStep_s = 1.0;  // far more than a clock is slewed by between two looks
  static constexpr Steady kStands = std::chrono::hours(1);

  std::optional<std::int64_t> offset_;
  double standing_s_ = 0.0;
  bool was_before_ = false;  ///< the step was before the start
  Steady since_{};
};

}  // namespace sealwatch
