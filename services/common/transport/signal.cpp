#include "services/common/transport/signal.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>

namespace sealwatch::transport {

Signal::Signal() : file_descriptor_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}

Signal::~Signal() {
  if (ok()) close(file_descriptor_);
}

void Signal::notify() {
  if (notified_.exchange(true)) return;  // a burst costs one system call
  const int saved = errno;               // a signal handler must leave it alone
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = write(file_descriptor_, &one, sizeof one);  // full means notified already
  errno = saved;
}

bool Signal::clear() {
  std::uint64_t count = 0;
  [[maybe_unused]] const auto got = read(file_descriptor_, &count, sizeof count);
  notified_ =
      false;  // last: a notification before this is seen by whoever looks after clear, one after it writes again
  return woken_.exchange(false);
}

void Signal::wait_until(std::chrono::steady_clock::time_point deadline) const {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now()).count();
  pollfd descriptor{.fd = file_descriptor_, .events = POLLIN, .revents = 0};
  poll(&descriptor, 1, static_cast<int>(std::clamp<std::int64_t>(left, 0, 3'600'000)));
}

}  // namespace sealwatch::transport
