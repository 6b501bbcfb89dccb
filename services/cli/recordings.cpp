#include "services/cli/recordings.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <utility>

#include "services/cli/session.hpp"
#include "services/common/recording/recording_file.hpp"
#include "services/common/text/words.hpp"

namespace sealwatch::cli {

void tell_left_aside(const Recording& recording, const std::string& plant) {
  if (recording.left_aside.empty()) return;
  std::fprintf(stderr, "sealwatch: %s: left aside, as plant %s does not know them: %s\n", recording.file.c_str(),
               plant.c_str(), text::joined(recording.left_aside).c_str());
}

void tell_warnings(const Recording& recording) {
  for (const std::string& warning : recording.warnings)
    std::fprintf(stderr, "sealwatch: warning: %s: %s\n", recording.file.c_str(), warning.c_str());
}

std::optional<std::vector<Recording>> read_recordings(const std::vector<std::string>& files, const AssetConfig& asset,
                                                      const PlantDescription& plant) {
  std::vector<Recording> recordings;
  std::vector<std::string> told, warned;  // of recordings of one kind once
  for (const std::string& file : files) {
    Result<std::vector<Recording>> read = read_recordings(file, plant, asset.channel_map);
    if (!read) {
      complain(read.error());
      return std::nullopt;
    }
    for (Recording& recording : *read) {
      if (!recording.asset_id.empty() && recording.asset_id != asset.asset_id) {
        complain(Error{.file = file,
                       .place = "asset_id",
                       .value = recording.asset_id,
                       .rule = "is not the asset " + asset.asset_id,
                       .advice = "give recordings of this one asset"});
        return std::nullopt;
      }
      recording.asset_id =
          asset.asset_id;  // without a sidecar too: cutting and aligning a test takes the asset's settings
      if (!recording.left_aside.empty() && recording.left_aside != told) tell_left_aside(recording, plant.name);
      told = recording.left_aside;
      if (recording.warnings != warned) tell_warnings(recording);
      warned = recording.warnings;
      recordings.push_back(std::move(recording));
    }
  }
  return recordings;
}

std::vector<std::string> names_of(const std::vector<Recording>& recordings) {
  std::vector<std::string> names;
  std::map<std::string, int> tests;  // of a file so far
  for (const Recording& recording : recordings) {
    const bool alone = std::ranges::count(recordings, recording.file, &Recording::file) == 1;
    names.push_back(alone ? recording.file : recording.file + "#" + std::to_string(++tests[recording.file]));
  }
  return names;
}

std::optional<Runaway> tell_runaway(const std::vector<Recording>& recordings, const AssetConfig& asset,
                                    const Deadline* deadline) {
  if (recordings.empty()) return std::nullopt;
  std::optional<Runaway> found = find_runaway(asset, recordings.front().samples, deadline);
  if (found)
    std::fprintf(stderr, "sealwatch: warning: %s: %s %s\n", recordings.front().file.c_str(), in_words(*found).c_str(),
                 advice_for_runaway().c_str());
  return found;
}

}  // namespace sealwatch::cli
