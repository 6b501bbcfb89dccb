// The sidecar NAME.yaml of a recording (docs/recordings.md); every key is optional, an unknown one is an error.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "sealwatch/core/recording.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "services/common/recording/columns.hpp"

namespace sealwatch {

struct Sidecar {
  std::string recording_id;
  std::string asset_id;
  TestKind test = TestKind::pst;
  std::optional<UtcTime> start_time;
  std::map<std::string, double> noise_std;  ///< by channel, in the unit of the recording's column
  bool interpolation_hold = false;          ///< "hold"; false: "linear"
  std::string note;
};

/// Reads a sidecar's text. Errors name line and key, not the file.
[[nodiscard]] Result<Sidecar> parse_sidecar(const std::string& text, const PlantDescription& plant);

/// Only the value of one key of a sidecar's text, "" when it has none: asset_id says which plant the rest is to be read
/// with.
[[nodiscard]] Result<std::string> parse_sidecar_value(const std::string& text, const std::string& key);

/// The sidecar's text; noise_std in SI.
[[nodiscard]] std::string format_sidecar(const Recording& recording);

/// Sets what the sidecar says on a recording whose samples came from `columns`; an Error where noise_std names
/// a channel that was not recorded.
[[nodiscard]] Status apply_sidecar(const Sidecar& sidecar, const std::vector<Column>& columns, Recording& recording);

}  // namespace sealwatch
