// Tests whose samples are more, denser or longer than one test may be (core/test_limits.hpp), as alarms: they are kept,
// and nothing is concluded from them. Who plays a recording back is told with its conclusions; of a live test, or one
// that was dropped, nobody else would hear. It stands until a later test of the asset is taken.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "sealwatch/port/standing_alarms.hpp"

namespace sealwatch {

/// How the reason begins for which such a test is marked as not complete.
inline constexpr const char* kRefused = "refused: ";

/// Looks at the layer's outputs in the order in which they were concluded.
class RefusedTests {
 public:
  /// Nothing where the output says nothing about them: no test, or an older one than was seen.
  [[nodiscard]] std::optional<StandingAlarms> look(const Message& output);

 private:
  std::map<std::string, std::int64_t> newest_ns_;  ///< by asset
};

}  // namespace sealwatch
