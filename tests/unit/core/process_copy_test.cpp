// No copy of the process finds a lock locked by a thread that it has not.
#include "sealwatch/core/process_copy.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <functional>
#include <thread>
#include <vector>

namespace sealwatch {
namespace {

constexpr unsigned kPatience_s = 10;  ///< of a copy that waits for a lock for ever

/// Whether `work` ends in a copy.
bool ends_in_a_copy(const std::function<void()>& work) {
  const pid_t copy = copy_process();
  if (copy == 0) {
    ::alarm(kPatience_s);
    work();
    ::_exit(0);
  }
  int status = 1;
  return copy > 0 && ::waitpid(copy, &status, 0) == copy && status == 0;
}

TEST(CopyOfTheProcess, FindsEveryLockFree) {
  constexpr int kCopies = 100, kThreads = 3;
  FreeInCopies outer, inner;
  std::atomic<bool> over = false;
  const auto hold = [&] {
    const std::scoped_lock lock(outer);
    const std::scoped_lock within(inner);
  };
  std::vector<std::thread> holding;
  for (int k = 0; k < kThreads; ++k)
    holding.emplace_back([&] {
      while (!over) hold();
    });
  int ended = 0;
  for (int k = 0; k < kCopies; ++k) ended += ends_in_a_copy(hold) ? 1 : 0;
  over = true;
  for (std::thread& thread : holding) thread.join();
  EXPECT_EQ(ended, kCopies);
}

TEST(CopyOfTheProcess, IsMadeByOneThreadAfterTheOther) {
  constexpr int kCopies = 100, kThreads = 3;
  FreeInCopies lock;
  const auto hold = [&] { const std::scoped_lock held(lock); };
  std::atomic<int> ended = 0;
  std::vector<std::thread> copying;
  for (int k = 0; k < kThreads; ++k)
    copying.emplace_back([&] {
      for (int copy = 0; copy < kCopies; ++copy) {
        hold();
        ended += ends_in_a_copy(hold) ? 1 : 0;
      }
    });
  for (std::thread& thread : copying) thread.join();
  EXPECT_EQ(ended, kCopies * kThreads);
}

}  // namespace
}  // namespace sealwatch
