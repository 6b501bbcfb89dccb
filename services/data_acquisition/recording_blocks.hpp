// A recording as a sender sends it: raw blocks of samples. Used by replay and by data acquisition's own folder of
// recordings, so that both give the same messages.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sealwatch/core/recording.hpp"
#include "sealwatch/message/data_acquisition.hpp"

namespace sealwatch {

inline constexpr const char* kFolderSource = "recordings_folder";  // source_id of what was dropped there
inline constexpr std::size_t kSamplesPerBlock = 200;               // a second at 200 Hz

/// Blocks 0, 1, 2, ... of at most `samples_per_block` rows, the last one marked as the end; message ids
/// "raw_samples/<asset>/<recording_id>/<content hash>/<number>", with "/no-time" before the number where the start time
/// is not known. `replay` marks them as recorded data.
[[nodiscard]] std::vector<RawSamples> blocks_of(const Recording& recording,
                                                std::size_t samples_per_block = kSamplesPerBlock,
                                                const std::string& source_id = "replay", bool replay = true);

/// What ends a test of which no more comes, as its sender would say it.
[[nodiscard]] RawSamples end_of(const SampleBlock& closing);

}  // namespace sealwatch
