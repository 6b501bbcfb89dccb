// What is known of one actuator and of the place where it works: plain data, filled by services/common/runtime from
// YAML (docs/asset-file.md) and by tests directly.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/config/channel_map.hpp"
#include "sealwatch/config/condition.hpp"
#include "sealwatch/core/time.hpp"

namespace sealwatch {

/// One physical parameter of the asset's model: psi_min <= psi <= psi_max, SI unit of the model's parameter table.
struct ParameterSetting {
  double value = 0.0;
  double min = 0.0;
  double max = 0.0;
  bool estimate = false;
  /// Standard deviation of a value that is not estimated about what the plant really has, same unit; 0: the plant
  /// table's (ParameterDescription::tolerance).
  double tolerance = 0.0;
  bool operator==(const ParameterSetting&) const = default;
};

/// One sensor. A zero range (max <= min) means that none is known.
struct SensorSetting {
  double noise_std = 0.0;        ///< channel's SI unit
  double time_constant_s = 0.0;  ///< first-order low-pass; 0: none
  double quantisation = 0.0;     ///< step, channel's SI unit; 0: none
  double range_min = 0.0;        ///< channel's SI unit
  double range_max = 0.0;
  /// Standard deviations of what the sensor is off by, (1 + gain_error) signal + offset_error; 0: as usual.
  double gain_tolerance = 0.0;    ///< 1
  double offset_tolerance = 0.0;  ///< channel's SI unit
  double gain_error = 0.0;        ///< as estimated within the tolerance
  double offset_error = 0.0;
  bool operator==(const SensorSetting&) const = default;
};

/// The partial stroke test as it should run (docs/model.md).
struct PstSetting {
  double start_m = 0.060;
  double stroke_m = -0.016;
  double speed_m_s = 1.33e-3;
  double hold_s = 3.0;
  double interval_months = 1.0;
  /// Expected length of a whole test [s]: rest, out, hold, back, hold.
  [[nodiscard]] double expected_duration_s() const {
    return 1.0 + 2.0 * (stroke_m < 0 ? -stroke_m : stroke_m) / speed_m_s + 2.0 * hold_s;
  }
};

/// Physics that `explain` found and that the model carries.
struct PhysicsTerm {
  std::string id;
  std::string element;
  std::map<std::string, ParameterSetting> parameters;  ///< of the law; a plain number in the file is fixed
};

/// Limits of one judged quantity: above (or below, when alarm < advisory) them the region changes.
struct AlertLimits {
  double advisory = 0.0;
  double warning = 0.0;
  double alarm = 0.0;
};

struct AssetConfig {
  std::string asset_id;
  std::string site;
  std::string segment;
  std::string model = "eha";
  std::map<std::string, ParameterSetting> parameters;  ///< all of the model's, defaults filled in
  std::map<std::string, SensorSetting> sensors;        ///< by channel; all of the model's, defaults filled in
  std::optional<ConditionSetting> condition;           ///< none: theta, and so the RUL, is not defined for this asset
  PstSetting pst;
  std::vector<PhysicsTerm> physics;
  std::map<std::string, AlertLimits> alert_limits;  ///< by quantity (config/judged_quantities.hpp); missing: defaults
  ChannelMap channel_map;                           ///< how its recordings are written; empty: as docs/recordings.md

  /// Value of a parameter that the model has (asserts that it has it).
  [[nodiscard]] double parameter(const std::string& name) const { return parameters.at(name).value; }
};

/// A vessel campaign that could replace an actuator.
struct Campaign {
  std::string label;  ///< "summer 2017"
  UtcTime start;
};

struct SiteConfig {
  std::string site;
  std::vector<Campaign> campaigns;         ///< sorted by start
  double booking_lead_time_months = 12.0;  ///< how long before a vessel must be booked
};

}  // namespace sealwatch
