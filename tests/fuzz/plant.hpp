// The plant that the fuzzers read recordings of, and the check of what they accept.
#pragma once

#include <cmath>
#include <cstdlib>

#include "sealwatch/core/time_series.hpp"
#include "sealwatch/model/plant_description.hpp"

namespace sealwatch {

inline PlantDescription fuzz_plant() {
  PlantDescription plant;
  plant.name = "eha";
  for (const auto& [name, unit] :
       {std::pair{"motor_voltage", "V"}, {"pressure_a", "Pa"}, {"flow", "m3/s"}, {"position", "m"}})
    plant.channels.push_back({.name = name, .unit = unit, .meaning = {}});
  return plant;
}

/// Whatever was accepted keeps the promises of core/time_series.hpp.
inline void check(const TimeSeries& samples) {
  const auto require = [](bool holds) {
    if (!holds) std::abort();
  };
  require(!samples.time_s.empty());
  for (std::size_t row = 0; row < samples.time_s.size(); ++row) {
    require(std::isfinite(samples.time_s[row]));
    require(row == 0 || samples.time_s[row] > samples.time_s[row - 1]);
  }
  for (const Series& channel : samples.channels) {
    require(channel.values.size() == samples.time_s.size());
    for (const double value : channel.values) require(std::isfinite(value));
  }
}

}  // namespace sealwatch
