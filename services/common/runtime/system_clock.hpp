// The one place that asks the operating system what time it is.
#pragma once

#include <chrono>

#include "sealwatch/core/time.hpp"

namespace sealwatch {

class SystemClock final : public Clock {
 public:
  [[nodiscard]] UtcTime now() const override {
    const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
    return {std::chrono::duration_cast<std::chrono::nanoseconds>(since_epoch).count()};
  }
};

}  // namespace sealwatch
