#include "services/common/core/in_parallel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <new>
#include <thread>

namespace sealwatch {
namespace {

using std::chrono::steady_clock;

TEST(InParallel, ResultsComeInTheOrderOfTheParts) {
  const auto squares = in_parallel<std::size_t>(100, 3, [](std::size_t k) { return k * k; });
  for (std::size_t k = 0; k < squares.size(); ++k) EXPECT_EQ(squares[k], k * k);
}

TEST(InParallel, MemoryThatEndsInOnePartIsTheCallersToTell) {
  const auto part = [](std::size_t k) { return k == 7 ? throw std::bad_alloc() : k; };
  EXPECT_THROW(static_cast<void>(in_parallel<std::size_t>(100, 3, part)), std::bad_alloc);
}

/// Whether two parts of `threads` threads run at the same time.
bool meet(int threads) {
  std::atomic<int> there = 0;  // with one thread never more than one
  std::atomic<bool> met = false;
  const auto until = steady_clock::now() + std::chrono::milliseconds(200);
  in_parallel<char>(2, threads, [&](std::size_t) {
    ++there;
    while (!met && steady_clock::now() < until) {
      if (there == 2) met = true;
      std::this_thread::yield();
    }
    --there;
    return char{};
  });
  return met;
}

TEST(InParallel, OneThreadDoesOnePartAfterTheOther) {
  std::atomic<int> at_once = 0, most = 0;
  in_parallel<char>(20, 1, [&](std::size_t) {
    most = std::max(most.load(), ++at_once);
    --at_once;
    return char{};
  });
  EXPECT_EQ(most, 1);
}

TEST(InParallel, APartTakesOverTheThreadsOfThoseThatHaveEndedAndGivesThemBack) {
  const auto until = steady_clock::now() + std::chrono::seconds(20);
  const auto met = in_parallel<char>(2, 2, [&](std::size_t k) -> char {
    int times = 0;
    while (k == 1 && times < 3 && steady_clock::now() < until) times += meet(1) ? 1 : 0;
    return times == 3;
  });
  EXPECT_TRUE(met[1]);
}

}  // namespace
}  // namespace sealwatch
