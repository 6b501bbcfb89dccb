// A disk on which the power can be cut between any two writes. While a recording runs, this program's own pwrite64,
// ftruncate64, fdatasync, fsync, open64 and unlink stand before the C library's and note what is done to the files of a
// directory; SQLite calls them. Afterwards the files are made anew as a cut could have left them: what was synced, and of
// what was not, nothing, all, or any part, in pieces of 512 bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <random>
#include <string>
#include <vector>

namespace sealwatch::testing {

class DiskRecording {
 public:
  /// Of files directly in `directory` whose names begin with "journal.db", but for SQLite's shared memory, which no cut
  /// leaves.
  explicit DiskRecording(std::filesystem::path directory);
  ~DiskRecording();
  DiskRecording(const DiskRecording&) = delete;
  DiskRecording& operator=(const DiskRecording&) = delete;

  /// From here on, whatever `what` says was confirmed.
  void confirm(std::string what);
  void stop();
  [[nodiscard]] std::size_t events() const { return events_.size(); }
  /// What was confirmed before the event of that number.
  [[nodiscard]] std::vector<std::string> confirmed_before(std::size_t event) const;

  enum class Unsynced { lost, kept, torn };
  /// Makes the files in `place` as a cut just before that event leaves them.
  void restore(std::size_t event, Unsynced unsynced, std::mt19937& random, const std::filesystem::path& place) const;

  /// Called by the functions that stand before the C library's.
  void note_write(int descriptor, const void* bytes, std::size_t size, std::int64_t offset);
  void note_truncate(int descriptor, std::int64_t size);
  void note_sync(int descriptor);
  void note_remove(const std::string& path);

 private:
  struct Event {
    enum class Kind { write, truncate, sync, remove, sync_directory, confirm } kind;
    std::string file;
    std::int64_t offset = 0;  ///< or size
    std::string bytes;        ///< or what is confirmed
  };
  [[nodiscard]] std::string file_of(int descriptor) const;
  [[nodiscard]] std::string file_of(const std::string& path) const;
  void add(Event event);

  const std::filesystem::path directory_;
  std::mutex mutex_;
  std::vector<Event> events_;
};

}  // namespace sealwatch::testing
