// What other threads had locked when a copy of the process was made does not hold up what is tried in it.
#include "services/common/runtime/trial.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <mutex>
#include <new>
#include <thread>

#include "sealwatch/model/physics.hpp"
#include "services/common/runtime/log.hpp"
#include "services/common/units/unit_conversion.hpp"

namespace sealwatch::testing {
namespace {

using std::chrono::milliseconds;

/// Of processor time alone: on a busy machine everything takes long by the clock. A copy that stands still does so.
std::string result_of(const std::function<void()>& work, milliseconds deadline = milliseconds(10'000),
                      milliseconds still = std::chrono::hours(1)) {
  const auto trial = Trial::begin(work, {.deadline = deadline, .by_clock = milliseconds(60'000), .still = still});
  for (;;) {
    if (const auto result = trial->result()) return *result;
    std::this_thread::sleep_for(milliseconds(1));
  }
}

/// Standard error as a pipe that nobody reads and that is full: who logs waits within its line.
class FullStandardError {
 public:
  FullStandardError() : before_(::dup(STDERR_FILENO)) {
    EXPECT_EQ(::pipe2(ends_.data(), O_CLOEXEC), 0);
    ::fcntl(ends_[1], F_SETFL, O_NONBLOCK);
    const std::array<char, 4096> page{};
    while (::write(ends_[1], page.data(), page.size()) > 0) continue;
    while (::write(ends_[1], page.data(), 1) > 0) continue;
    ::fcntl(ends_[1], F_SETFL, 0);
    ::dup2(ends_[1], STDERR_FILENO);
  }
  void drain() {
    ::dup2(before_, STDERR_FILENO);
    ::close(ends_[1]);
    std::array<char, 4096> page{};
    while (::read(ends_[0], page.data(), page.size()) > 0) continue;
    ::close(ends_[0]);
    ::close(before_);
  }

 private:
  int before_;
  std::array<int, 2> ends_{};
};

TEST(TrialTest, WhatLogsIsNotHeldUpByAThreadThatWasWithinALine) {
  ASSERT_TRUE(start_logging({}, "state_detection"));
  FullStandardError full;
  std::thread logging([] { log_event(LogLevel::warn, "a line that waits"); });
  std::this_thread::sleep_for(milliseconds(200));
  const std::string result = result_of([] { log_event(LogLevel::warn, "another"); });
  full.drain();
  logging.join();
  stop_logging();
  EXPECT_EQ(result, "");
}

/// Of copies that are made while another thread does `work` again and again: of the first that does not end well.
std::string result_beside(const std::function<void()>& work) {
  constexpr int kCopies = 200;
  std::atomic<bool> over = false;
  std::thread other([&] {
    while (!over) work();
  });
  std::string result;
  for (int k = 0; k < kCopies && result.empty(); ++k) result = result_of(work, milliseconds(2000));
  over = true;
  other.join();
  return result;
}

TEST(TrialTest, WhatConvertsUnitsIsNotHeldUpByAThreadThatDid) {
  EXPECT_EQ(result_beside([] { EXPECT_TRUE(convert_unit("furlong/fortnight", "m/s")); }), "");
}

TEST(TrialTest, WhatKeepsATextIsNotHeldUpByAThreadThatDid) {
  EXPECT_EQ(result_beside([] { EXPECT_EQ(kept("a law's equation"), "a law's equation"); }), "");
}

TEST(TrialTest, WhatRaisesAnExceptionIsNotHeldUpByAThreadThatDid) {
  const auto raise = [] {
    try {
      throw std::runtime_error("no such phase");
    } catch (const std::runtime_error&) {
    }
  };
  EXPECT_EQ(result_beside(raise), "");
}

TEST(TrialTest, WhatWaitsForAProcessorIsNotOverdueButWhatComputesIs) {
  EXPECT_EQ(result_of([] { std::this_thread::sleep_for(milliseconds(600)); }, milliseconds(500)), "");
  const auto computes = [] {
    for (volatile bool for_ever = true; for_ever;) continue;
  };
  EXPECT_EQ(result_of(computes, milliseconds(1000)), "it did not end within 1 s");
}

/// A number that copies of the process share.
class Shared {
 public:
  Shared()
      : number_(new (::mmap(nullptr, sizeof(std::atomic<int>), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1,
                            0)) std::atomic<int>(0)) {}
  ~Shared() { ::munmap(number_, sizeof(std::atomic<int>)); }
  Shared(const Shared&) = delete;
  Shared& operator=(const Shared&) = delete;
  std::atomic<int>& operator*() const { return *number_; }

 private:
  std::atomic<int>* number_;
};

TEST(TrialTest, ACopyThatWaitsForAThreadItDoesNotHaveIsReplaced) {
  std::mutex of_a_library;
  const Shared copies;
  std::atomic<bool> is_locked = false;
  std::thread other([&] {
    const std::lock_guard lock(of_a_library);
    is_locked = true;
    while (*copies == 0) std::this_thread::sleep_for(milliseconds(1));
  });
  while (!is_locked) std::this_thread::sleep_for(milliseconds(1));
  const auto waits = [&] {
    ++*copies;
    const std::lock_guard lock(of_a_library);
  };
  EXPECT_EQ(result_of(waits, milliseconds(10'000), milliseconds(300)), "");
  EXPECT_EQ(*copies, 2);
  other.join();
}

TEST(TrialTest, WhatStandsStillInEveryCopyIsSaidTo) {
  const Shared copies;
  const auto waits = [&] {
    ++*copies;
    ::pause();
  };
  EXPECT_EQ(result_of(waits, milliseconds(10'000), milliseconds(200)), "it stood still, each time it was tried");
  EXPECT_EQ(*copies, 3);
}

TEST(TrialTest, ACopyThatWaitsForAProcessOfItsOwnDoesNotStandStill) {
  const Shared copies;
  const auto waits = [&] {
    ++*copies;
    const pid_t child = ::fork();
    if (child == 0) {
      ::usleep(900'000);
      ::_exit(0);
    }
    ::waitpid(child, nullptr, 0);
  };
  EXPECT_EQ(result_of(waits, milliseconds(10'000), milliseconds(200)), "");
  EXPECT_EQ(*copies, 1);
}

TEST(TrialTest, AFailureIsNotHiddenByTheSilentLog) {
  EXPECT_EQ(result_of([] { throw std::runtime_error("no such phase"); }), "no such phase");
}

}  // namespace
}  // namespace sealwatch::testing
