#include "services/data_acquisition/recordings_folder.hpp"

#include <algorithm>
#include <utility>

#include "sealwatch/core/text.hpp"
#include "sealwatch/core/visible_text.hpp"
#include "sealwatch/model/plant_description.hpp"
#include "services/common/recording/recording_file.hpp"
#include "services/data_acquisition/put_away.hpp"
#include "services/data_acquisition/recording_blocks.hpp"

namespace sealwatch {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostFilesPerLook = 16;  // so that a full folder does not fill the memory
constexpr const char* kSourceId = "recordings_folder";

}  // namespace

RecordingsFolder::RecordingsFolder(fs::path directory, std::vector<AssetConfig> assets, IsConcluded is_concluded,
                                   Report report, int looks_until_settled)
    : directory_(std::move(directory)),
      assets_(std::move(assets)),
      is_concluded_(std::move(is_concluded)),
      report_(std::move(report)),
      looks_until_settled_(looks_until_settled) {
  std::error_code error;
  fs::create_directories(directory_, error);
  if (error)
    report_(Error{.file = directory_.string(),
                  .place = "recordings_directory",
                  .value = {},
                  .rule = "could not be made: " + error.message(),
                  .advice = "make it, or let the service write there"});
}

std::vector<Message> RecordingsFolder::look() {
  put_away_concluded();
  std::vector<Message> messages;
  std::size_t taken = 0;
  const std::vector<fs::path> there = recordings();
  std::erase_if(files_, [&](const auto& file) { return !std::ranges::binary_search(there, file.first); });
  for (const fs::path& path : there) {
    if (taken == kMostFilesPerLook) break;
    const bool settled = is_settled(path);
    File& file = files_[path];
    // Refused after it was read (its start time lay in the future), and mended since: another recording.
    if (file.taken && file.unchanged_looks == 0) file.taken = file.stuck = false;
    if (file.taken || !settled) continue;
    take(path, messages);
    ++taken;
  }
  return messages;
}

/// CSV, MAT and HDF5 files right in the folder, by name.
std::vector<fs::path> RecordingsFolder::recordings() {
  std::vector<fs::path> paths;
  std::error_code error;
  for (fs::directory_iterator entry(directory_, error), end; !error && entry != end; entry.increment(error)) {
    const std::string suffix = suffix_of(entry->path().string());
    std::error_code ignored;
    const bool is_one = suffix == ".csv" || suffix == ".mat" || suffix == ".h5" || suffix == ".hdf5";
    if (is_one && !entry->is_directory(ignored)) paths.push_back(entry->path());
  }
  const bool was_readable = std::exchange(is_readable_, !error);
  if (error && was_readable)
    report_(Error{.file = directory_.string(),
                  .place = "recordings_directory",
                  .value = {},
                  .rule = "cannot be read: " + error.message(),
                  .advice = "make it again, or let the service read it; nothing dropped there is taken meanwhile"});
  std::sort(paths.begin(), paths.end());
  return paths;
}

void RecordingsFolder::put_away_concluded() {
  for (auto file = files_.begin(); file != files_.end();) {
    const bool concluded = file->second.taken && !file->second.stuck && is_concluded_(file->second.first_block);
    const bool gone = concluded && move_to("done", file->first);
    file->second.stuck = file->second.stuck || (concluded && !gone);
    file = gone ? files_.erase(file) : std::next(file);
  }
}

bool RecordingsFolder::is_settled(const fs::path& path) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);  // none of a pipe or a device, which is refused in its turn
  const fs::file_time_type changed = fs::last_write_time(path, error);
  if (error) return fs::is_symlink(fs::symlink_status(path, error));  // which leads nowhere, and is refused in its turn
  const fs::file_time_type sidecar_changed = fs::last_write_time(fs::path(path).replace_extension(".yaml"), error);
  File& file = files_[path];
  const bool same = file.size == size && file.changed == changed && file.sidecar_changed == sidecar_changed;
  file.size = size;
  file.changed = changed;
  file.sidecar_changed = sidecar_changed;
  file.unchanged_looks = same ? file.unchanged_looks + 1 : 0;
  return file.unchanged_looks >= looks_until_settled_;
}

void RecordingsFolder::take(const fs::path& path, std::vector<Message>& messages) {
  if (const auto link = not_a_file_of_its_own(path)) return reject(path, *link);
  Result<Recording> recording = read(path);
  if (!recording) return reject(path, recording.error());
  std::vector<RawSamples> blocks = blocks_of(*recording, kSamplesPerBlock, kSourceId, false);
  if (blocks.empty())
    return reject(path, Error{.file = path.string(), .place = {}, .value = {}, .rule = "has no samples", .advice = {}});
  File& file = files_[path];
  file.taken = true;
  file.first_block = blocks.front();
  file.first_block.samples = {};
  for (RawSamples& block : blocks) messages.emplace_back(std::move(block));
}

Result<Recording> RecordingsFolder::read(const fs::path& path) const {
  const Result<std::string> asset_id = recorded_asset_id(path.string());
  if (!asset_id) return fail(asset_id.error());
  const auto asset = std::find_if(assets_.begin(), assets_.end(),
                                  [&](const AssetConfig& candidate) { return candidate.asset_id == *asset_id; });
  if (asset == assets_.end()) {
    std::vector<std::string> known;
    for (const AssetConfig& candidate : assets_) known.push_back(candidate.asset_id);
    return fail(Error{.file = path.string(),
                      .place = "asset_id",
                      .value = *asset_id,
                      .rule = asset_id->empty() ? "names no asset" : "is not a configured asset",
                      .advice = asset_id->empty() ? "say which in its sidecar" : suggest(*asset_id, known)});
  }
  const Result<const PlantDescription*> plant = find_plant(asset->model);
  if (!plant) return fail(plant.error());
  return read_recording(path.string(), **plant, asset->channel_map);
}

std::optional<fs::path> RecordingsFolder::move_to(const std::string& folder, const fs::path& path) {
  const Result<fs::path> place = put_away(path, folder);
  if (place) return *place;
  report_(place.error());
  return std::nullopt;
}

void RecordingsFolder::reject(const fs::path& path, const Error& error) {
  report_(error);
  const std::optional<fs::path> place = move_to("rejected", path);
  if (!place) {
    files_[path].taken = true;
    files_[path].stuck = true;
    return;
  }
  files_.erase(path);
  write_new(place->string() + ".error.txt", visible(error.describe()) + "\n");
}

}  // namespace sealwatch
