// Samples of several channels over one common time axis, SI units, no gaps (a missing sample is an absent row).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sealwatch/core/fields.hpp"

namespace sealwatch {

struct Series {
  std::string name;            ///< channel name of docs/recordings.md, e.g. "pressure_a"
  std::string unit;            ///< SI unit, e.g. "Pa"
  double noise_std = 0.0;      ///< standard deviation of one sample's noise, in `unit`; 0 when not known
  std::vector<double> values;  ///< one per time
  SEALWATCH_FIELDS(Series, name, unit, noise_std, values)
  friend bool operator==(const Series&, const Series&) = default;
};

struct TimeSeries {
  std::vector<double> time_s;    ///< seconds since the start of the recording, strictly increasing
  std::vector<Series> channels;  ///< each with time_s.size() values
  bool input_hold = false;       ///< motor_voltage between samples: true = held, false = linear
  SEALWATCH_FIELDS(TimeSeries, time_s, channels, input_hold)
  friend bool operator==(const TimeSeries&, const TimeSeries&) = default;

  [[nodiscard]] const Series* find(std::string_view name) const {
    for (const Series& channel : channels)
      if (channel.name == name) return &channel;
    return nullptr;
  }
  [[nodiscard]] bool has(std::string_view name) const { return find(name) != nullptr; }
};

}  // namespace sealwatch
