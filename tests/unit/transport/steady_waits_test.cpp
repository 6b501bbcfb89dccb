// Waits inside the DDS library while the wall clock is set: they last as long as they should.
#include <dds/ddsrt/sync.h>
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "services/common/transport/dds_bus.hpp"

namespace {
/// How much this process's wall clock is ahead of the kernel's: to begin a wait by a clock that is ahead is what happens to a
/// wait during which the clock is set back.
std::atomic<long> ahead_s = 0;
}  // namespace

extern "C" int clock_gettime(clockid_t clock, timespec* time) noexcept {
  const auto failed = static_cast<int>(::syscall(SYS_clock_gettime, clock, time));
  if (failed == 0 && clock == CLOCK_REALTIME) time->tv_sec += ahead_s;
  return failed;
}

namespace sealwatch {
namespace {

using std::chrono::seconds;
using std::chrono::steady_clock;

constexpr long kHour = 3600;

class SteadyWaits : public ::testing::TestWithParam<long> {
 protected:
  SteadyWaits() {
    EXPECT_TRUE(check_dds_settings({}));  // the bus is in this program
    ddsrt_mutex_init(&mutex_);
    ddsrt_cond_init(&condition_);
    ahead_s = GetParam();
  }
  ~SteadyWaits() override { ahead_s = 0; }

  /// Whether `wait` ended by itself and after its tenth of a second, not by the signal after five.
  bool ends_in_time(bool (*wait)(ddsrt_cond_t*, ddsrt_mutex_t*)) {
    std::atomic<bool> ended = false;
    std::thread signal([&] {
      for (const auto end = steady_clock::now() + seconds(5); !ended && steady_clock::now() < end;)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      while (!ended) {
        ddsrt_cond_signal(&condition_);
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      }
    });
    const auto begin = steady_clock::now();
    ddsrt_mutex_lock(&mutex_);
    const bool signalled = wait(&condition_, &mutex_);
    ddsrt_mutex_unlock(&mutex_);
    const auto took = steady_clock::now() - begin;
    ended = true;
    signal.join();
    return !signalled && took >= std::chrono::milliseconds(100);
  }

  ddsrt_mutex_t mutex_{};
  ddsrt_cond_t condition_{};
};

INSTANTIATE_TEST_SUITE_P(Clock, SteadyWaits, ::testing::Values(0, kHour, -kHour));

TEST_P(SteadyWaits, ADurationLastsNoLongerAndNoShorterWhenTheWallClockIsSet) {
  EXPECT_TRUE(ends_in_time([](ddsrt_cond_t* condition, ddsrt_mutex_t* mutex) {
    return ddsrt_cond_waitfor(condition, mutex, DDS_MSECS(100));
  }));
}

TEST_P(SteadyWaits, SoDoesAWaitUntilATime) {
  EXPECT_TRUE(ends_in_time([](ddsrt_cond_t* condition, ddsrt_mutex_t* mutex) {
    return ddsrt_cond_waituntil(condition, mutex, dds_time() + DDS_MSECS(101));
  }));
}

}  // namespace
}  // namespace sealwatch
