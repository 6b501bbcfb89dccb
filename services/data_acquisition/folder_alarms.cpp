#include "services/data_acquisition/folder_alarms.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <functional>
#include <system_error>
#include <utility>

#include "sealwatch/core/visible_text.hpp"
#include "sealwatch/port/local_inputs.hpp"

namespace sealwatch {
namespace {

namespace fs = std::filesystem;

/// There is room for other alarms.
constexpr std::size_t kMostNamed = 8;
constexpr std::size_t kLongestReason = 400;

std::int64_t changed_ns(const fs::path& file) {
  struct stat found {};
  if (::lstat(file.c_str(), &found) != 0) return -1;
  return std::int64_t{found.st_mtim.tv_sec} * 1'000'000'000 + found.st_mtim.tv_nsec;
}

std::string text_of(const fs::path& file) {
  std::array<char, kLongestReason> text{};
  std::ifstream stream;
  if (fs::is_regular_file(fs::symlink_status(file))) stream.open(file);
  stream.read(text.data(), text.size());
  std::string read(text.data(), static_cast<std::size_t>(stream.gcount()));
  while (read.ends_with('\n')) read.pop_back();
  return read.empty() ? "its reason could not be written beside it: see the log" : visible(read, false);
}

}  // namespace

ServiceAlarm recording_alarm(const std::string& subject, const std::string& text, std::int64_t since_ns) {
  return {.kind = kRecordingNotTaken,
          .asset_id = {},
          .subject = visible(subject, false),
          .pst_id = {},
          .text = text,
          .since_ns = since_ns};
}

void RejectedRecordings::look(const fs::path& directory) {
  const fs::path rejected = directory / "rejected";
  const std::int64_t changed = changed_ns(rejected);
  // Once more after the last change seen: a folder's time is coarse.
  if (std::exchange(is_settled_, changed == changed_ns_) && is_settled_) return;
  changed_ns_ = changed;
  reasons_.clear();
  std::error_code error;
  for (fs::directory_iterator entry(rejected, error), end; !error && entry != end; entry.increment(error))
    if (entry->path().string().ends_with(kReasonSuffix))
      reasons_.push_back({changed_ns(entry->path()), entry->path(), {}});
  std::ranges::sort(reasons_, std::less<>());
  for (std::size_t k = 0; k < std::min(kMostNamed, reasons_.size()); ++k) reasons_[k].text = text_of(reasons_[k].file);
}

std::vector<ServiceAlarm> RejectedRecordings::alarms() const {
  constexpr const char* kAdvice = "; mend it and drop it again, and remove it with its reason from rejected/";
  std::vector<ServiceAlarm> alarms;
  for (const Reason& reason : reasons_) {
    const std::string file = reason.file.filename().string();
    const std::string name = file.substr(0, file.size() - std::string_view(kReasonSuffix).size());
    if (alarms.size() == kMostNamed) {
      alarms.push_back(recording_alarm("others",
                                       std::to_string(reasons_.size() - kMostNamed) +
                                           " more recordings were rejected, the first of them " + visible(name, false) +
                                           ": see rejected/",
                                       reason.since_ns));
      break;
    }
    alarms.push_back(recording_alarm(name, "a recording was rejected: " + reason.text + kAdvice, reason.since_ns));
  }
  return alarms;
}

}  // namespace sealwatch
