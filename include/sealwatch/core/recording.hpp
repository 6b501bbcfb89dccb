// One test of one actuator as it was recorded (docs/recordings.md), already in SI units.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sealwatch/core/time.hpp"
#include "sealwatch/core/time_series.hpp"

namespace sealwatch {

SEALWATCH_ENUM(TestKind, pst, full_stroke, other)

struct Recording {
  std::string file;          ///< where it came from, as the user named it
  std::string recording_id;  ///< sidecar's recording_id, else the file's stem
  std::string asset_id;      ///< sidecar's asset_id, else ""
  TestKind test = TestKind::pst;
  std::optional<UtcTime> start_time;  ///< unknown when the sidecar gives none
  std::string content_hash;           ///< of the file's bytes (16 hex digits)
  std::string note;
  std::vector<std::string> left_aside = {};  ///< header cells of columns that the plant does not know
  std::vector<std::string> warnings = {};    ///< of units that the file says otherwise than its map
  TimeSeries samples;                        ///< channel noise_std set where the sidecar gives it
};

}  // namespace sealwatch
