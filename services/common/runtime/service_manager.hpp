// What a daemon tells the service manager (systemd's sd_notify protocol; nothing where there is none), and the lock
// that keeps a second instance away from the same state.
#pragma once

#include <string>
#include <utility>

#include "sealwatch/core/result.hpp"

namespace sealwatch {

/// "READY=1", "WATCHDOG=1", "STOPPING=1", "STATUS=...".
void notify_service_manager(const std::string& state);

/// Held while the object lives; the kernel lets go of it however the process ends.
class InstanceLock {
 public:
  /// Locks "<directory>/<service>.lock", making the directory where there is none. Who holds it stands in the file, where
  /// the disk has room for that: the lock holds without.
  [[nodiscard]] static Result<InstanceLock> take(const std::string& directory, const std::string& service);
  ~InstanceLock();
  InstanceLock(InstanceLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  InstanceLock& operator=(InstanceLock&&) = delete;

 private:
  explicit InstanceLock(int descriptor) : descriptor_(descriptor) {}
  int descriptor_ = -1;
};

/// Whether it says that another process has the lock.
[[nodiscard]] bool is_held_by_another(const Error& error);
/// Whether it says that the disk, or the user's share of it, is full: no fault of the configuration, and it may have
/// room again.
[[nodiscard]] bool is_for_want_of_space(const Error& error);

}  // namespace sealwatch
