// Reading a file of channels that no plant describes: whatever its header names.
#pragma once

#include <string>

#include "sealwatch/config/channel_map.hpp"
#include "sealwatch/core/recording.hpp"
#include "sealwatch/core/result.hpp"

namespace sealwatch::cli {

/// The samples in `file`, in SI units by the header's units: every column of numbers is a channel of its own name but for
/// those that `map` renames. The time is `map`'s, or the column called time, t, Timestamp or Zeit, or the first.
[[nodiscard]] Result<Recording> read_any_channels(const std::string& file, const ChannelMap& map);

/// The same of a simulation's trace beside a recording: of the recording's map those rows count that the file has the
/// columns of; its other columns have names of their own.
[[nodiscard]] Result<Recording> read_simulated_channels(const std::string& file, const ChannelMap& of_recording);

}  // namespace sealwatch::cli
