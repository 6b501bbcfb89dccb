// Sensors that an asset has lost, as alarms: a channel that was OK in most earlier tests and is not in the newest one
// (not recorded, frozen, out of range), or one that is recorded and dead from the first test on. It stands from the
// first test without the channel until a later one has it again, the actuator is replaced, or the channel is expected no
// more (history.hpp).
#pragma once

#include <map>
#include <optional>
#include <string>

#include "sealwatch/port/standing_alarms.hpp"

namespace sealwatch {

/// Looks at the layer's outputs in the order in which they were concluded.
class LostSensors {
 public:
  /// Nothing where the output says nothing about them: no test, or an older one than was seen. After a retraction what is
  /// said of the last test that counts holds.
  [[nodiscard]] std::optional<StandingAlarms> look(const Message& output);

 private:
  std::map<std::string, std::int64_t> newest_ns_;  ///< by asset
};

}  // namespace sealwatch
