// Sets of recordings for blind trials. A set follows from its stratum and its seed alone, in memory.
//
//   null            nothing hidden: the model's own equations in other code
//   single          one effect of the interface's list, each in turn, in sizes from barely to plainly visible
//   pair            two effects at once
//   outside         physics without a name in the catalogue
//   sensor          bias, gain or lag of one sensor
//   recording       gain, bias or delay of the recorded input, or a clock that is fast or slow
//   source_sensors  flow, pressures, position and velocity alone; with nothing, an effect or a sensor's fault
//   concealed       two nominal tests, on which free parameters absorb the effect, and two under other conditions
//   inseparable     two explanations that these channels and tests cannot tell apart
//   nominal_only    effects that free parameters absorb, and nothing but nominal tests
//   asset_file      no physics hidden: one value of the datasheet that is not estimated is wrong
//
// Four recordings to fit and two held out under loads and speeds that no fit has, 100 Hz, 30 to 60 s each. The seven
// free parameters are drawn about the datasheet; noise is white or coloured, some channels are rounded, some sets have
// jittered sampling.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sealwatch/config/asset.hpp"
#include "sealwatch/core/recording.hpp"
#include "services/verification/truth/plant.hpp"

namespace sealwatch {

SEALWATCH_ENUM(TrialStratum, null, single, pair, outside, sensor, recording, source_sensors, concealed, inseparable,
               nominal_only, asset_file)

}  // namespace sealwatch

namespace sealwatch::bench {

/// Everything that is drawn for one channel.
struct TrialNoise {
  double standard_deviation = 0.0;  ///< channel's unit
  double correlation = 0.0;         ///< from one sample to the next
  double quantum = 0.0;             ///< rounding step
};

struct SensorFault {
  std::string kind;     ///< sensor_bias, sensor_gain, sensor_lag; input_bias, input_gain, input_delay; clock_rate
  std::string channel;  ///< "" of the clock
  double size = 0.0;    ///< channel's unit, 1, s
};

/// Another explanation.
struct TruthRival {
  std::vector<HiddenEffect> effects = {};
  std::vector<SensorFault> faults = {};
};

struct PlannedTrialTest {
  Profile profile;
  double load_factor = 0.0;  ///< Phi
  std::uint64_t seed = 0;    ///< of noise and jitter
};

/// A value of the plant that is not what the datasheet says.
struct WrongValue {
  std::string name;    ///< as the interface names it: "A_C"; "": none
  double share = 0.0;  ///< by which the plant's is larger
};

/// What is hidden, as the interface names it.
struct TrialTruth {
  std::string id, element, form;
  double size = 0.0;
  std::string unit;
  std::string strength;  ///< of the catalogue, where one means the same; else ""
  double strength_value = 0.0;
  double times_barely = 0.0;  ///< size over what such tests begin to show
};

struct TrialPlan {
  TrialStratum stratum = TrialStratum::null;
  std::uint64_t seed = 0;
  TruthParameters parameters;  ///< load: phi
  std::vector<HiddenEffect> effects;
  std::vector<SensorFault> faults;
  WrongValue wrong_value;
  std::map<std::string, TrialNoise> noise;  ///< by channel
  std::vector<std::string> channels;
  double tolerance = 0.0;  ///< by which the values that the asset fixes were drawn
  double jitter = 0.0;     ///< share of the sampling period that a sample may be off
  std::vector<PlannedTrialTest> fit, holdout;
  /// Inseparable sets: what the hidden effect cannot be told from, "id element", and its physics of about that size.
  std::string twin;
  TruthRival twin_physics;

  [[nodiscard]] std::vector<TrialTruth> truths() const;
  /// One line with everything that is hidden: what is sealed before the engine's thresholds are frozen.
  [[nodiscard]] std::string label() const;
};

/// `tolerance`: share by which every value that the asset fixes is drawn about the datasheet (standard deviation); 0:
/// the plant has the datasheet's values.
[[nodiscard]] TrialPlan plan_trial(TrialStratum stratum, std::uint64_t seed, double tolerance = 0.0);

struct TrialRecordings {
  std::vector<Recording> fit, holdout;
};
[[nodiscard]] Result<TrialRecordings> record_trial(const TrialPlan& plan);

/// What the engine is given, as from an asset file: the datasheet, seven parameters free, all others fixed.
[[nodiscard]] AssetConfig trial_asset();

/// Hash of the labels of the sets with the seeds first .. first + count - 1.
[[nodiscard]] std::string label_hash(TrialStratum stratum, std::uint64_t first, int count, double tolerance = 0.0);

}  // namespace sealwatch::bench
