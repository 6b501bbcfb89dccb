// How well this machine's clock is kept, as its kernel knows from whoever disciplines it (chrony, systemd-timesyncd).
#pragma once

#include "sealwatch/core/fields.hpp"

namespace sealwatch {

/// stepped: it was set by more than a second within the last hour, or is still off by that.
SEALWATCH_ENUM(ClockQuality, unknown, synchronised, unsynchronised, stepped)

struct ClockReading {
  ClockQuality quality = ClockQuality::unknown;  ///< unknown where the kernel may not be asked
  bool error_known = false;
  double error_s = 0.0;  ///< the kernel's estimate of how far the clock is off
  friend bool operator==(const ClockReading&, const ClockReading&) = default;
};

[[nodiscard]] ClockReading read_clock();

}  // namespace sealwatch
