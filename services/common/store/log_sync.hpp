// Brings SQLite's write-ahead log to the disk from another thread than the one that commits to it, which does not wait.
// A log is whole up to a commit: what was committed before the call, and all before that, is then there after a power
// cut.
#pragma once

#include <mutex>
#include <string>

namespace sealwatch {

class LogSync {
 public:
  /// The log of a journal that is open and stays so: it is not made anew meanwhile.
  explicit LogSync(std::string file) : file_(std::move(file)) {}
  ~LogSync();
  LogSync(const LogSync&) = delete;
  LogSync& operator=(const LogSync&) = delete;

  /// False for ever after the disk has failed once: the kernel may have dropped what it could not write.
  [[nodiscard]] bool sync();

 private:
  const std::string file_;
  std::mutex mutex_;
  int descriptor_ = -1;
  bool failed_ = false;
};

}  // namespace sealwatch
