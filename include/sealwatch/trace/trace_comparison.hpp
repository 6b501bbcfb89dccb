// A trace of somebody's simulation beside a recording of the same channels: whether they differ beyond noise, when and in
// which regime, and whether a simple alteration of a channel, of the input or of a clock would make one the other.
//
// Noise is what knows nothing of the simulation, of whatever colour (coloured_regression.hpp); whatever depends on the
// simulated course is a difference. A trace alone cannot name physics: what the plant lacks moves several balances at
// once, and only equations say how.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "sealwatch/core/result.hpp"
#include "sealwatch/core/time_series.hpp"

namespace sealwatch::trace {

struct Options {
  std::vector<std::string> inputs;  ///< channels that drive the simulation
  double significance = 0.01;       ///< of the verdict over all channels
  std::function<void(std::size_t done, std::size_t total)> progress = {};
};

/// What an alteration sets: "gain" 1.021 +- 0.002.
struct AlteredParameter {
  std::string name;
  double value = 0.0;
  double std_error = 0.0;
  std::string unit;
};

/// What would have to be done to the simulation's course to come nearer to the recording.
struct Alteration {
  std::string id;     ///< "sensor_gain", "sensor_bias", "sensor_lag", "sign", "clock_rate", "input_gain", "input_bias",
                      ///< "input_delay", "input_sign"
  std::string where;  ///< "sensor:position", "input:motor_voltage", "input", "clock"
  std::vector<AlteredParameter> parameters;
  double removed_share = 0.0;  ///< of the misfit beyond noise, 0..1
  bool would_do = false;       ///< what is left is noise
  double criterion = 0.0;      ///< less is better, among alterations of the same channels
};

struct RegimeMisfit {
  std::string name;           ///< "at rest", "moving up"
  double time_share = 0.0;    ///< of the recording
  double rms = 0.0;           ///< of the difference, the channel's unit
  double misfit_share = 0.0;  ///< of the sum of squares
};

struct MisfitInterval {
  double begin_s = 0.0, end_s = 0.0;
  double misfit_share = 0.0;
};

struct ChannelComparison {
  std::string name, unit;
  bool input = false;
  double rms = 0.0;                ///< of recorded - simulated
  double noise_std = 0.0;          ///< of what nothing in the simulation explains
  double effective_samples = 0.0;  ///< of that noise
  double nrmse_percent = 0.0;      ///< 100: the same
  bool differs = false;
  bool stands_still = false;   ///< the recorded channel, while the simulated one moves
  bool sign_reversed = false;  ///< turned round, the simulated course is far nearer to the recorded one
  double p_value = 1.0;
  std::vector<std::string> by;  ///< the groups of regressors that tell, most telling first
  std::vector<RegimeMisfit> regimes;
  std::vector<MisfitInterval> intervals;
  std::vector<Alteration> alterations;  ///< of this channel alone, what removes most first
  std::vector<double> recorded, simulated;
};

struct TraceComparison {
  std::vector<double> time_s;
  std::vector<ChannelComparison> channels;
  std::vector<std::string> only_recorded, only_simulated;
  std::string motion;              ///< by which channel the regimes are told
  std::vector<Alteration> common;  ///< of all channels at once: clock, input
  bool consistent = true;
  std::vector<Alteration> answer;   ///< what together would do; empty: none of these, or nothing needed
  std::vector<Alteration> equally;  ///< each instead of a single answer: the trace cannot tell them apart
  std::vector<std::string> remarks;
};

/// Channels in SI units, of the same names in both. An Error where they share none or hardly any time, or where one name
/// is two quantities.
[[nodiscard]] Result<TraceComparison> compare_traces(const TimeSeries& recorded, const TimeSeries& simulated,
                                                     const Options& options);

}  // namespace sealwatch::trace
