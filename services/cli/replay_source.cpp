#include "services/cli/replay_source.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <utility>

#include "sealwatch/core/text.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "services/cli/operator_send.hpp"
#include "services/cli/recordings.hpp"
#include "services/cli/session.hpp"
#include "services/common/recording/recording_file.hpp"
#include "services/common/runtime/asset_file.hpp"
#include "services/common/runtime/channel_map_file.hpp"
#include "services/data_acquisition/recording_blocks.hpp"

namespace sealwatch::cli {
namespace {

std::optional<Error> not_a_file(const std::string& file) {
  std::error_code none;  // of a link to itself, a name that is too long
  const bool folder = std::filesystem::is_directory(file, none);
  if (std::filesystem::exists(file, none) && !folder) return std::nullopt;
  return Error{.file = file,
               .place = {},
               .value = {},
               .rule = folder ? "is a folder" : "does not exist",
               .advice = folder ? "give its recordings: " + (std::filesystem::path(file) / "*.csv").string() : ""};
}

}  // namespace

std::optional<ReplaySource> ReplaySource::open(const ReplayOptions& options, const Configuration& configuration) {
  ReplaySource source;
  source.configuration_ = &configuration;
  source.admission_ = Admission(configuration.commissioned);
  source.files_ = options.recordings;
  if (!options.asset_file.empty()) {
    const auto asset = load_asset_or_explain(options.asset_file, options.map_file);
    if (!asset) return std::nullopt;
    source.asset_ = asset->asset_id;
    if (!asset->channel_map.empty()) source.map_ = asset->channel_map;
  } else if (!options.map_file.empty()) {
    auto map = check_channel_map(options.map_file, nullptr);
    if (!map) {
      complain(combine(map.error()));
      return std::nullopt;
    }
    source.map_ = std::move(*map);
  }
  // One that is missing is passed over as one that is damaged; where all are, nothing needs to be started.
  if (std::ranges::all_of(source.files_, [](const std::string& file) { return not_a_file(file).has_value(); })) {
    for (const std::string& file : source.files_) complain(*not_a_file(file));
    return std::nullopt;
  }
  source.put_in_order();
  return source;
}

// Each test is judged with those before it: names need not sort as times do (PST-10 stands before PST-2).
void ReplaySource::put_in_order() {
  std::vector<std::pair<UtcTime, std::string>> in_order;
  for (const std::string& file : files_)
    in_order.emplace_back(recorded_start_time(file).value_or(UtcTime{std::numeric_limits<std::int64_t>::max()}), file);
  std::ranges::stable_sort(in_order, {}, &std::pair<UtcTime, std::string>::first);
  std::vector<std::string> sorted;
  for (auto& [time, file] : in_order) sorted.push_back(std::move(file));
  if (sorted != files_)
    std::fprintf(stderr, "sealwatch: the recordings are played in the order of their start times\n");
  files_ = std::move(sorted);
}

Result<Recording> ReplaySource::read(const std::string& file) const {
  if (const auto error = not_a_file(file)) return fail(*error);
  Result<std::string> asset_id = recorded_asset_id(file);
  if (!asset_id) return fail(asset_id.error());
  if (!asset_.empty() && !asset_id->empty() && *asset_id != asset_)
    return fail(Error{.file = file,
                      .place = "asset_id",
                      .value = *asset_id,
                      .rule = "is not the asset " + asset_,
                      .advice = "give recordings of this one asset, or leave --asset out"});
  if (asset_id->empty()) *asset_id = asset_;
  const AssetConfig* asset = configuration_->find_asset(*asset_id);
  if (asset == nullptr) {
    std::vector<std::string> known;
    for (const AssetConfig& candidate : configuration_->assets) known.push_back(candidate.asset_id);
    return fail(Error{.file = file,
                      .place = "asset_id",
                      .value = *asset_id,
                      .rule = asset_id->empty() ? "names no asset" : "is not a configured asset",
                      .advice = asset_id->empty()
                                    ? "say which with --asset FILE, or with asset_id in a sidecar (docs/recordings.md)"
                                    : suggest(*asset_id, known)});
  }
  const Result<const PlantDescription*> plant = find_plant(asset->model);
  if (!plant) return fail(plant.error());
  Result<Recording> recording = read_recording(file, **plant, map_.value_or(asset->channel_map));
  if (recording) tell_left_aside(*recording, (*plant)->name), tell_warnings(*recording);
  if (recording) recording->asset_id = *asset_id;
  return recording;
}

Result<std::vector<RawSamples>> ReplaySource::blocks(const std::string& file) {
  const Result<Recording> recording = read(file);
  if (!recording) return fail(recording.error());
  std::vector<RawSamples> blocks = blocks_of(*recording);
  if (blocks.empty()) return blocks;
  const Message first(blocks.front());
  if (const auto refused = admission_.refusal(first, UtcTime{now_ns()}))
    return fail(Error{.file = file, .place = {}, .value = {}, .rule = *refused, .advice = {}});
  admission_.note(first);
  return blocks;
}

std::vector<RawSamples> ReplaySource::next() {
  while (next_ < files_.size()) {
    Result<std::vector<RawSamples>> blocks_of_next = blocks(files_[next_++]);
    if (blocks_of_next) return std::move(*blocks_of_next);
    complain(blocks_of_next.error());
    ++failures_;
  }
  return {};
}

}  // namespace sealwatch::cli
