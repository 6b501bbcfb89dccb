#include "sealwatch/core/clock_reading.hpp"

#include <sys/timex.h>

namespace sealwatch {

ClockReading read_clock() {
  timex state{};  // modes 0: it only asks
  if (::adjtimex(&state) == -1) return {};
  if ((state.status & STA_UNSYNC) != 0) return {.quality = ClockQuality::unsynchronised};
  constexpr double kMicrosecond_s = 1e-6;
  // Who disciplines the clock without an estimate of its error leaves 0 there.
  return {.quality = ClockQuality::synchronised,
          .error_known = state.esterror > 0,
          .error_s = static_cast<double>(state.esterror) * kMicrosecond_s};
}

}  // namespace sealwatch
