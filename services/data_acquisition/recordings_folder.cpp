#include "services/data_acquisition/recordings_folder.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <new>
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

std::int64_t now_ns() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
}

/// In its file system; zero of none.
std::uintmax_t number_of(const fs::path& file) {
  struct stat found {};
  return ::stat(file.c_str(), &found) == 0 ? found.st_ino : 0;
}

}  // namespace

RecordingsFolder::RecordingsFolder(fs::path directory, std::vector<AssetConfig> assets, IsConcluded is_concluded,
                                   Report report, int looks_until_settled, const RetentionConfig& kept)
    : directory_(std::move(directory)),
      assets_(std::move(assets)),
      is_concluded_(std::move(is_concluded)),
      report_(std::move(report)),
      looks_until_settled_(looks_until_settled),
      old_(kept) {
  std::error_code error;
  fs::create_directories(directory_, error);
  if (error)
    report_(Error{.file = directory_.string(),
                  .place = "recordings_directory",
                  .value = {},
                  .rule = "could not be made: " + error.message(),
                  .advice = "make it, or let the service write there"});
}

void RecordingsFolder::look() {
  put_away_finished();
  old_.look(directory_, std::chrono::system_clock::now(), std::chrono::steady_clock::now());
  rejected_.look(directory_);
  const std::vector<fs::path> there = recordings();
  std::erase_if(files_, [&](const auto& file) { return !std::ranges::binary_search(there, file.first); });
  to_read_.clear();
  for (const fs::path& path : there) {
    const bool settled = is_settled(path);
    File& file = files_[path];
    // Refused after it was read (its start time lay in the future), and mended since: another recording.
    if (file.taken && file.unchanged_looks == 0) {
      file.taken = false;
      file.rejected.reset();
      file.stuck.clear();
    }
    if (!file.taken && settled) to_read_.push_back(path);
  }
}

std::optional<std::vector<RawSamples>> RecordingsFolder::read_next() {
  if (to_read_.empty()) return std::nullopt;
  const fs::path path = std::move(to_read_.front());
  to_read_.pop_front();
  // Others may have taken long to read: it may have changed, or gone, since it was looked at.
  if (stamp_of(path) != files_[path].stamp) return std::vector<RawSamples>();
  return take(path);
}

bool RecordingsFolder::all_taken() const {
  return is_readable_ && std::ranges::all_of(files_, [](const auto& file) { return file.second.taken; });
}

std::vector<RawSamples> RecordingsFolder::awaiting() const {
  std::vector<RawSamples> first_blocks;
  for (const auto& [path, file] : files_)
    if (file.taken && !file.rejected) first_blocks.push_back(file.first_block);
  return first_blocks;
}

std::vector<ServiceAlarm> RecordingsFolder::alarms() const {
  std::vector<ServiceAlarm> alarms = rejected_.alarms();
  if (!is_readable_) alarms.push_back(recording_alarm("recordings_directory", unreadable_, unreadable_ns_));
  std::size_t stuck = 0;
  const File* first = nullptr;
  for (const auto& [path, file] : files_) {
    if (file.stuck.empty()) continue;
    ++stuck;
    if (first == nullptr || file.stuck_ns < first->stuck_ns) first = &file;
  }
  if (first != nullptr)
    alarms.push_back(recording_alarm(
        "stuck", std::to_string(stuck) + " read and still in the folder; the first " + visible(first->stuck),
        first->stuck_ns));
  return alarms;
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
  if (error && was_readable) {
    const Error unreadable{
        .file = directory_.string(),
        .place = "recordings_directory",
        .value = {},
        .rule = "cannot be read: " + error.message(),
        .advice = "make it again, or let the service read it; nothing dropped there is taken meanwhile"};
    unreadable_ = unreadable.describe();
    unreadable_ns_ = now_ns();
    report_(unreadable);
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

bool RecordingsFolder::is_finished(const File& file) const {
  return file.rejected || (file.taken && is_concluded_(file.first_block));
}

/// What was overwritten since it was read is another recording, whose test nobody has seen: the look that follows finds
/// it changed, and reads it.
void RecordingsFolder::put_away_finished() {
  for (auto file = files_.begin(); file != files_.end();) {
    const bool is_over = is_finished(file->second) && stamp_of(file->first) == file->second.stamp;
    file = is_over && move_away(file->first, file->second) ? files_.erase(file) : std::next(file);
  }
}

std::optional<RecordingsFolder::Stamp> RecordingsFolder::stamp_of(const fs::path& path) {
  std::error_code error;
  Stamp stamp;
  stamp.size = fs::file_size(path, error);  // none of a pipe or a device, which is refused in its turn
  stamp.changed = fs::last_write_time(path, error);
  if (error) {
    Stamp link;
    link.leads_nowhere = fs::is_symlink(fs::symlink_status(path, error));
    return link.leads_nowhere ? std::optional(link) : std::nullopt;
  }
  const fs::path sidecar = fs::path(path).replace_extension(".yaml");
  stamp.sidecar_changed = fs::last_write_time(sidecar, error);
  stamp.number = number_of(path);
  stamp.sidecar_number = number_of(sidecar);
  return stamp;
}

bool RecordingsFolder::is_settled(const fs::path& path) {
  const std::optional<Stamp> stamp = stamp_of(path);
  if (!stamp) return false;
  File& file = files_[path];
  const bool same = file.stamp == stamp;
  file.stamp = stamp;
  file.unchanged_looks = same ? file.unchanged_looks + 1 : 0;
  return file.unchanged_looks >= looks_until_settled_ || stamp->leads_nowhere;
}

std::vector<RawSamples> RecordingsFolder::take(const fs::path& path) {
  Result<std::vector<RawSamples>> read = blocks(path);
  File& file = files_[path];
  if (stamp_of(path) != file.stamp) return {};  // it changed meanwhile: half of it may be of one, half of another
  if (!read) return reject(path, read.error()), std::vector<RawSamples>();
  file.taken = true;
  file.first_block = read->front();
  file.first_block.samples = {};
  return std::move(*read);
}

/// A file that hides more than there is memory for is refused like any other that cannot be read.
Result<std::vector<RawSamples>> RecordingsFolder::blocks(const fs::path& path) const {
  const auto wrong = [&](std::string rule) {
    return fail(Error{.file = path.string(), .place = {}, .value = {}, .rule = std::move(rule), .advice = {}});
  };
  if (const auto link = not_a_file_of_its_own(path)) return fail(*link);
  try {
    const Result<Recording> recording = read(path);
    if (!recording) return fail(recording.error());
    std::vector<RawSamples> all = blocks_of(*recording, kSamplesPerBlock, kFolderSource, false);
    if (all.empty()) return wrong("has no samples");
    return all;
  } catch (const std::bad_alloc&) {
    return wrong("takes more memory than there is");
  } catch (const std::exception& raised) {
    return wrong(std::string("cannot be read: ") + raised.what());
  }
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

bool RecordingsFolder::move_away(const fs::path& path, File& file) {
  const Result<fs::path> place = put_away(path, file.rejected ? "rejected" : "done");
  if (!place) {
    if (file.stuck.empty()) {
      report_(place.error());
      file.stuck_ns = now_ns();
    }
    file.stuck = place.error().rule + "; " + place.error().advice;
    return false;
  }
  if (file.rejected) write_new(place->string() + kReasonSuffix, visible(file.rejected->describe()) + "\n");
  return true;
}

void RecordingsFolder::reject(const fs::path& path, const Error& error) {
  report_(error);
  File& file = files_[path];
  file.taken = true;
  file.rejected = error;
  if (move_away(path, file)) files_.erase(path);
}

}  // namespace sealwatch
