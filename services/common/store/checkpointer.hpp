// Moves what was committed from SQLite's write-ahead log into the database file, in a thread and a connection of its
// own: that waits for the disk, up to a tenth of a second, for which a service would receive nothing. Writers go on
// meanwhile. Nothing depends on it but the length of the log.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <string>
#include <thread>

namespace sealwatch {

class Checkpointer {
 public:
  explicit Checkpointer(std::string connection) : connection_(std::move(connection)) {}
  ~Checkpointer();
  Checkpointer(const Checkpointer&) = delete;
  Checkpointer& operator=(const Checkpointer&) = delete;

  /// So many rows were committed: every now and then the thread is woken.
  void committed(std::size_t rows);
  /// Whether the log is long and all but its end is in the file: true once. Without a pause between its batches a
  /// writer must then move the rest itself, or the log would grow as long as the load lasts.
  [[nodiscard]] bool nearly_done() { return nearly_done_.exchange(false); }

 private:
  void run();
  void checkpoint();

  std::string connection_;
  std::size_t rows_ = 0;  ///< since the thread was woken; the owner's thread alone
  std::atomic<bool> nearly_done_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  bool wanted_ = false;
  bool stopping_ = false;
  std::thread thread_;  ///< from the first time on
};

}  // namespace sealwatch
