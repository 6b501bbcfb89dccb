// One test on the virtual bench: plant `eha` with the cascaded controller, sensors, noise. Same input, same recording,
// bit for bit on one machine and compiler.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/recording.hpp"
#include "sealwatch/core/result.hpp"
#include "services/virtual_bench/controller.hpp"
#include "services/virtual_bench/profile.hpp"
#include "services/virtual_bench/sensors.hpp"

namespace sealwatch::bench {

/// What is true of the actuator during this test, over what the asset file believes.
struct TestConditions {
  std::map<std::string, double> parameters = {};  ///< by name, e.g. {"R_CL", 1e13}; the asset's values for the others
  double load_factor = 0.0;                       ///< Phi: load = phi (1 + Phi)
};

struct TestSetting {
  double sample_rate_Hz = 200.0;
  std::uint64_t seed = 1;  ///< of the sensors' noise
  std::vector<std::string> channels = default_channels();
  ControllerSetting controller = {};
};

/// Runs `profile`, recorded from its start to its end. recording_id, start_time and note are left to the caller.
[[nodiscard]] Result<Recording> simulate_test(const AssetConfig& asset, const Profile& profile,
                                              const TestConditions& conditions, const TestSetting& setting);

}  // namespace sealwatch::bench
