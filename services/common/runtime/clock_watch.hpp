// Whether this machine's clock was set while the service ran, seen against the steady clock, which nobody sets:
//
//   offset = now - steady,  a step = offset that changes by more than 1 s from one look to the next
//
// A step stands until the clock is back where it was, or for an hour in which there was no other. A machine that slept
// shows one too: the steady clock stops with it.
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
    if (std::abs(standing_s_) <= kStep_s || steady - since_ > kStands) standing_s_ = 0.0;
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
  Steady since_{};
};

}  // namespace sealwatch
