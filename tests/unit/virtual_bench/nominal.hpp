// The nominal asset and small statistics for the bench's tests.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <span>

#include "sealwatch/model/plant_description.hpp"
#include "services/virtual_bench/simulate_test.hpp"

namespace sealwatch::bench {

inline AssetConfig nominal_asset() {
  AssetConfig asset;
  asset.asset_id = "XT03-MV2";
  asset.condition = ConditionSetting{
      .parameter = "R_CL", .at_100 = 2.6e13, .at_60 = 4.64e12, .unit = "Pa s/m3", .part = "piston seal"};
  return asset;  // parameters and sensors: the plant's defaults
}

/// Sensors without noise.
inline AssetConfig quiet_asset() {
  AssetConfig asset = nominal_asset();
  for (const ChannelDescription& channel : find_plant("eha").value()->channels)
    asset.sensors[channel.name] = {.time_constant_s = channel.time_constant_s};
  return asset;
}

inline Recording run(const AssetConfig& asset, const TestConditions& conditions = {}, const TestSetting& setting = {}) {
  Result<Recording> recording = simulate_test(asset, pst_profile(asset.pst), conditions, setting);
  EXPECT_TRUE(recording) << recording.error().describe();
  return recording ? *recording : Recording{};
}

inline std::span<const double> between(const Recording& recording, const std::string& channel, double from_s,
                                       double to_s) {
  const std::vector<double>& time = recording.samples.time_s;
  const auto first = std::lower_bound(time.begin(), time.end(), from_s) - time.begin();
  const auto last = std::lower_bound(time.begin(), time.end(), to_s) - time.begin();
  return std::span(recording.samples.find(channel)->values).subspan(first, last - first);
}

inline double mean(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

inline double standard_deviation(std::span<const double> values) {
  const double centre = mean(values);
  double sum = 0.0;
  for (const double value : values) sum += (value - centre) * (value - centre);
  return std::sqrt(sum / static_cast<double>(values.size() - 1));
}

}  // namespace sealwatch::bench
