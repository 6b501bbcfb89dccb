#include "tests/unit/store/power_cut.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <fstream>
#include <utility>

namespace sealwatch::testing {
namespace {

constexpr std::size_t kSector = 512;

std::atomic<DiskRecording*> running = nullptr;

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

/// A file as it is on the disk, and what was done to it since it was synced.
struct File {
  struct Change {
    std::int64_t offset;
    std::string bytes;
    bool truncates = false;
  };
  std::string synced;
  std::vector<Change> unsynced;
  bool is_in_directory = false;
};

void apply(std::string& content, const File::Change& change) {
  const auto offset = static_cast<std::size_t>(change.offset);
  if (change.truncates) return content.resize(offset);
  content.resize(std::max(content.size(), offset + change.bytes.size()));
  std::ranges::copy(change.bytes, content.begin() + change.offset);
}

/// Each sector of a write reaches the disk by itself.
void apply_torn(std::string& content, const File::Change& change, std::mt19937& random) {
  if (change.truncates) {
    if (random() % 2 == 0) apply(content, change);
    return;
  }
  for (std::size_t from = 0; from < change.bytes.size(); from += kSector)
    if (random() % 2 == 0)
      apply(content, {change.offset + static_cast<std::int64_t>(from), change.bytes.substr(from, kSector)});
}

std::string content_after_cut(const File& file, DiskRecording::Unsynced unsynced, std::mt19937& random) {
  std::string content = file.synced;
  if (unsynced == DiskRecording::Unsynced::lost) return content;
  for (const File::Change& change : file.unsynced)
    unsynced == DiskRecording::Unsynced::kept ? apply(content, change) : apply_torn(content, change, random);
  return content;
}

}  // namespace

DiskRecording::DiskRecording(std::filesystem::path directory) : directory_(std::move(directory)) { running = this; }
DiskRecording::~DiskRecording() { stop(); }
void DiskRecording::stop() { running = nullptr; }

std::string DiskRecording::file_of(const std::string& path) const {
  const std::filesystem::path file(path);
  const std::string name = file.filename().string();
  return file.parent_path() == directory_ && name.starts_with("journal.db") && !name.ends_with("-shm") ? name : "";
}

std::string DiskRecording::file_of(int descriptor) const {
  std::array<char, 4096> path{};
  const ssize_t size =
      ::readlink(("/proc/self/fd/" + std::to_string(descriptor)).c_str(), path.data(), path.size() - 1);
  if (size <= 0) return {};
  const std::string known(path.data(), static_cast<std::size_t>(size));
  return known == directory_.string() ? "." : file_of(known);
}

void DiskRecording::add(Event event) {
  const std::lock_guard lock(mutex_);
  events_.push_back(std::move(event));
}

void DiskRecording::confirm(std::string what) { add({Event::Kind::confirm, {}, 0, std::move(what)}); }

void DiskRecording::note_write(int descriptor, const void* bytes, std::size_t size, std::int64_t offset) {
  if (std::string file = file_of(descriptor); !file.empty())
    add({Event::Kind::write, std::move(file), offset, std::string(static_cast<const char*>(bytes), size)});
}

void DiskRecording::note_truncate(int descriptor, std::int64_t size) {
  if (std::string file = file_of(descriptor); !file.empty()) add({Event::Kind::truncate, std::move(file), size, {}});
}

void DiskRecording::note_sync(int descriptor) {
  std::string file = file_of(descriptor);
  if (file.empty()) return;
  const auto kind = file == "." ? Event::Kind::sync_directory : Event::Kind::sync;
  add({kind, std::move(file), 0, {}});
}

void DiskRecording::note_remove(const std::string& path) {
  if (std::string file = file_of(path); !file.empty()) add({Event::Kind::remove, std::move(file), 0, {}});
}

std::vector<std::string> DiskRecording::confirmed_before(std::size_t event) const {
  std::vector<std::string> confirmed;
  for (std::size_t k = 0; k < event; ++k)
    if (events_[k].kind == Event::Kind::confirm) confirmed.push_back(events_[k].bytes);
  return confirmed;
}

void DiskRecording::restore(std::size_t event, Unsynced unsynced, std::mt19937& random,
                            const std::filesystem::path& place) const {
  std::map<std::string, File> files;
  for (std::size_t k = 0; k < event; ++k) {
    const Event& done = events_[k];
    switch (done.kind) {
      case Event::Kind::write:
        files[done.file].unsynced.push_back({done.offset, done.bytes});
        break;
      case Event::Kind::truncate:
        files[done.file].unsynced.push_back({done.offset, {}, true});
        break;
      case Event::Kind::sync:
        for (const File::Change& change : std::exchange(files[done.file].unsynced, {}))
          apply(files[done.file].synced, change);
        break;
      case Event::Kind::remove:
        files.erase(done.file);
        break;
      case Event::Kind::sync_directory:
        for (auto& [name, file] : files) file.is_in_directory = true;
        break;
      case Event::Kind::confirm:
        break;
    }
  }
  std::filesystem::remove_all(place);
  std::filesystem::create_directories(place);
  for (const auto& [name, file] : files) {
    if (!file.is_in_directory && unsynced == Unsynced::lost) continue;
    std::ofstream(place / name, std::ios::binary) << content_after_cut(file, unsynced, random);
  }
}

}  // namespace sealwatch::testing

// NOLINTBEGIN: the C library's names and arguments
extern "C" {

ssize_t pwrite64(int descriptor, const void* bytes, size_t size, off64_t offset) {
  static auto* const original = sealwatch::testing::next<ssize_t(int, const void*, size_t, off64_t)>("pwrite64");
  if (auto* recording = sealwatch::testing::running.load()) recording->note_write(descriptor, bytes, size, offset);
  return original(descriptor, bytes, size, offset);
}

int ftruncate64(int descriptor, off64_t size) {
  static auto* const original = sealwatch::testing::next<int(int, off64_t)>("ftruncate64");
  if (auto* recording = sealwatch::testing::running.load()) recording->note_truncate(descriptor, size);
  return original(descriptor, size);
}

int fdatasync(int descriptor) {
  static auto* const original = sealwatch::testing::next<int(int)>("fdatasync");
  const int result = original(descriptor);
  if (auto* recording = sealwatch::testing::running.load(); recording && result == 0) recording->note_sync(descriptor);
  return result;
}

int fsync(int descriptor) {
  static auto* const original = sealwatch::testing::next<int(int)>("fsync");
  const int result = original(descriptor);
  if (auto* recording = sealwatch::testing::running.load(); recording && result == 0) recording->note_sync(descriptor);
  return result;
}

int unlink(const char* path) noexcept {
  static auto* const original = sealwatch::testing::next<int(const char*)>("unlink");
  if (auto* recording = sealwatch::testing::running.load()) recording->note_remove(path);
  return original(path);
}
}
// NOLINTEND
