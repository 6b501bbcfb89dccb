#include "services/common/store/log_sync.hpp"

#include <fcntl.h>
#include <unistd.h>

namespace sealwatch {

LogSync::~LogSync() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

bool LogSync::sync() {
  const std::lock_guard lock(mutex_);
  if (descriptor_ < 0) descriptor_ = ::open(file_.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor_ < 0) return false;
  if (::fdatasync(descriptor_) != 0) failed_ = true;
  return !failed_;
}

}  // namespace sealwatch
