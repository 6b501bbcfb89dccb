// Why a service does not simulate a test (core/test_limits.hpp), asked by whoever simulates or estimates beside other
// tests: state detection and the estimator of prognostic assessment.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "sealwatch/core/test_limits.hpp"
#include "sealwatch/model/simulation.hpp"

namespace sealwatch {

/// In words that say what to do instead; nothing for a test that can be simulated.
[[nodiscard]] inline std::optional<std::string> too_long_to_simulate(std::span<const double> times_s) {
  if (times_s.empty()) return std::nullopt;
  return too_long_to_simulate(times_s.back() - times_s.front(), longest_step_s(times_s));
}

}  // namespace sealwatch
