#include "services/data_acquisition/put_away.hpp"

#include <fcntl.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string_view>
#include <system_error>

#include "services/data_acquisition/folder_alarms.hpp"

namespace sealwatch {
namespace {

namespace fs = std::filesystem;

constexpr int kMostOfOneName = 10'000;
/// Of a file system's longest name, without what a reason beside it needs.
constexpr std::size_t kLongestName = 255 - std::string_view(kReasonSuffix).size();

Error error_of(const fs::path& file, std::string rule, std::string advice) {
  return {.file = file.string(), .place = {}, .value = {}, .rule = std::move(rule), .advice = std::move(advice)};
}

/// What cannot be looked at may be there, but under a name too long for any file (a recording's may have no room for a
/// sidecar's) nothing is.
bool is_there(const fs::path& file) {
  std::error_code error;
  const bool is_missing = fs::symlink_status(file, error).type() == fs::file_type::not_found;
  return !is_missing && error != std::errc::filename_too_long;
}

fs::path sidecar_of(fs::path recording) { return recording.replace_extension(".yaml"); }

fs::path numbered(const fs::path& name, int count) {
  const std::string end = (count == 1 ? "" : "." + std::to_string(count)) + name.extension().string();
  return name.stem().string().substr(0, kLongestName - end.size()) + end;
}

/// Zero, or errno. Not every file system can rename without replacing; then what is_there saw must do.
int rename_to_new(const fs::path& from, const fs::path& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
  if (errno != EINVAL) return errno;
  if (is_there(to)) return EEXIST;
  return ::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
}

}  // namespace

std::optional<Error> not_a_file_of_its_own(const fs::path& recording) {
  for (const fs::path& file : {recording, sidecar_of(recording)}) {
    std::error_code ignored;
    const fs::file_type type = fs::symlink_status(file, ignored).type();
    if (type == fs::file_type::symlink)
      return error_of(file, "is a symbolic link, which is not followed here", "put the file itself into the folder");
  }
  return std::nullopt;
}

Result<fs::path> put_away(const fs::path& recording, const std::string& folder) {
  const fs::path target = recording.parent_path() / folder;
  std::error_code error;
  fs::create_directories(target, error);
  const auto cannot = [&](const std::string& why) {
    return fail(
        error_of(recording, "could not be moved to " + target.string() + ": " + why, "let the service write there"));
  };
  if (fs::symlink_status(target, error).type() != fs::file_type::directory) return cannot("it is not a folder");
  for (int count = 1; count <= kMostOfOneName; ++count) {
    const fs::path place = target / numbered(recording.filename(), count);
    if (is_there(place) || is_there(sidecar_of(place))) continue;
    const int moved = rename_to_new(recording, place);
    if (moved == EEXIST) continue;
    if (moved != 0) return cannot(std::strerror(moved));
    // The sidecar goes last: a recording that is left without it would be another recording.
    if (is_there(sidecar_of(recording)) && rename_to_new(sidecar_of(recording), sidecar_of(place)) != 0)
      return cannot("its sidecar stayed behind");
    return place;
  }
  return cannot("too many files of this name are there");
}

void write_new(const fs::path& file, const std::string& text) {
  std::FILE* const out = std::fopen(file.c_str(), "wx");
  if (out == nullptr) return;
  std::fputs(text.c_str(), out);
  std::fclose(out);
}

}  // namespace sealwatch
