// What a waiting receive waits for: an eventfd, so that wake() may be called from a signal handler (DDS's own guard
// conditions take a mutex and may not) and a DDS listener need only write to it.
#pragma once

#include <atomic>
#include <chrono>
#include <utility>

namespace sealwatch::transport {

class Signal {
 public:
  Signal();
  ~Signal();
  Signal(const Signal&) = delete;
  Signal& operator=(const Signal&) = delete;
  [[nodiscard]] bool ok() const { return file_descriptor_ >= 0; }
  /// Something arrived. Async-signal-safe, as wake is.
  void notify();
  /// Somebody wants the waiting thread back.
  void wake() {
    woken_ = true;
    notify();
  }
  /// Forgets notifications so far; whether one of them was a wake.
  bool clear();
  /// Waits for a notification at most until `deadline`.
  void wait_until(std::chrono::steady_clock::time_point deadline) const;

 private:
  int file_descriptor_;
  std::atomic<bool> notified_ = false;
  std::atomic<bool> woken_ = false;
  static_assert(std::atomic<bool>::is_always_lock_free);
};

}  // namespace sealwatch::transport
