#include "sealwatch/core/process_copy.hpp"

#include <unistd.h>

#include <atomic>
#include <cassert>
#include <cstdint>

namespace sealwatch {
namespace {

// How many threads hold locks, and whether a copy is being made. No condition variable: in a copy it would go on waiting
// for the threads that are not there.
constexpr std::uint32_t kCopying = 1U << 31U;
std::atomic<std::uint32_t> holders = 0;
thread_local unsigned held_by_this_thread = 0;

void begin_holding() {
  for (std::uint32_t now = holders.load();;) {
    if ((now & kCopying) != 0) {
      holders.wait(now);
      now = holders.load();
    } else if (holders.compare_exchange_weak(now, now + 1)) {
      return;
    }
  }
}

void end_holding() {
  if (holders.fetch_sub(1) == (kCopying | 1U)) holders.notify_all();
}

// New holders wait from now on, so that those that are there come to an end.
void begin_copying() {
  for (std::uint32_t before = holders.fetch_or(kCopying); (before & kCopying) != 0;) {  // another thread makes a copy
    holders.wait(before);
    before = holders.fetch_or(kCopying);
  }
  for (std::uint32_t now = holders.load(); now != kCopying; now = holders.load()) holders.wait(now);
}

void end_copying() {
  holders.store(0);
  holders.notify_all();
}

}  // namespace

void FreeInCopies::lock() {
  if (held_by_this_thread++ == 0) begin_holding();
  mutex_.lock();
}

void FreeInCopies::unlock() {
  mutex_.unlock();
  if (--held_by_this_thread == 0) end_holding();
}

pid_t copy_process() {
  assert(held_by_this_thread == 0);
  begin_copying();
  const pid_t process = ::fork();
  end_copying();
  return process;
}

}  // namespace sealwatch
