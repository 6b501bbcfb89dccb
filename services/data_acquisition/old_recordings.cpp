#include "services/data_acquisition/old_recordings.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "services/data_acquisition/folder_alarms.hpp"

namespace sealwatch {
namespace {

constexpr std::chrono::minutes kBetweenLooks{1};
/// A clock that was set by more since the first look is not trusted until the service starts again.
constexpr std::chrono::minutes kSet{1};
constexpr double kDay_s = 86'400.0;

/// A recording with all that belongs to it.
struct Kept {
  double put_away_s = 0.0;  ///< the latest of its files, since 1970
  double bytes = 0.0;
  std::vector<std::string> files;
};

/// "april" of april.csv, april.yaml and april.csv.error.txt.
std::string name_of(std::string file) {
  if (file.ends_with(kReasonSuffix)) file.resize(file.size() - std::string_view(kReasonSuffix).size());
  return file.substr(0, file.rfind('.'));
}

using Folder = std::unique_ptr<DIR, int (*)(DIR*)>;

/// Not through a link.
Folder open_folder(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  DIR* const folder = descriptor < 0 ? nullptr : ::fdopendir(descriptor);
  if (folder == nullptr && descriptor >= 0) ::close(descriptor);
  return {folder, ::closedir};
}

/// The oldest first.
std::vector<Kept> recordings_in(DIR* folder) {
  std::map<std::string, Kept> by_name;
  while (const dirent* const entry = ::readdir(folder)) {
    struct stat found {};
    if (::fstatat(::dirfd(folder), entry->d_name, &found, AT_SYMLINK_NOFOLLOW) != 0 || !S_ISREG(found.st_mode))
      continue;
    Kept& kept = by_name[name_of(entry->d_name)];
    // Since it has its name here: a recording that is copied keeps the time of its content.
    kept.put_away_s = std::max(kept.put_away_s, static_cast<double>(found.st_ctim.tv_sec));
    kept.bytes += static_cast<double>(found.st_blocks) * 512.0;
    kept.files.emplace_back(entry->d_name);
  }
  std::vector<Kept> all;
  for (auto& [name, kept] : by_name) all.push_back(std::move(kept));
  std::ranges::stable_sort(all, {}, &Kept::put_away_s);
  return all;
}

void trim(const std::filesystem::path& path, const RetentionConfig& limits, double now_s) {
  const Folder folder = open_folder(path);
  if (!folder) return;
  const std::vector<Kept> all = recordings_in(folder.get());
  double bytes = 0.0;
  for (const Kept& one : all) bytes += one.bytes;
  for (const Kept& one : all) {
    const bool is_old = limits.days > 0.0 && now_s - one.put_away_s > limits.days * kDay_s;
    const bool is_too_much = limits.megabytes > 0.0 && bytes > limits.megabytes * 1e6;
    if (!is_old && !is_too_much) return;
    for (const std::string& file : one.files) (void)::unlinkat(::dirfd(folder.get()), file.c_str(), 0);
    bytes -= one.bytes;
  }
}

}  // namespace

bool OldRecordings::is_trusted(Wall now, Steady steady) {
  const auto ahead = std::chrono::nanoseconds(now.time_since_epoch()) - steady.time_since_epoch();
  if (!ahead_) ahead_ = ahead;
  return std::chrono::abs(ahead - *ahead_) <= kSet;
}

void OldRecordings::look(const std::filesystem::path& directory, Wall now, Steady steady) {
  if (kept_.days <= 0.0 && kept_.megabytes <= 0.0) return;
  if (last_look_ && steady - *last_look_ < kBetweenLooks) return;
  last_look_ = steady;
  RetentionConfig limits = kept_;
  if (!is_trusted(now, steady)) limits.days = 0.0;
  for (const char* const folder : {"done", "rejected"})
    trim(directory / folder, limits, std::chrono::duration<double>(now.time_since_epoch()).count());
}

}  // namespace sealwatch
