// Independent parts of a computation on several threads; the results come in the order of the parts, so that sums over
// them do not depend on the number of threads. A part may itself have parts: these take over the threads of those that
// have ended, as parts seldom take equally long.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace sealwatch {

/// Threads that have no parts any more, of one call of in_parallel().
class SpareThreads {
 public:
  void give(int threads = 1) { count_ += threads; }
  /// Whether there was one.
  [[nodiscard]] bool take() {
    int count = count_;
    while (count > 0)
      if (count_.compare_exchange_weak(count, count - 1)) return true;
    return false;
  }

 private:
  std::atomic<int> count_ = 0;
};

/// Of the call whose part this thread works on; none elsewhere.
inline thread_local SpareThreads* spare_threads = nullptr;

/// f(0), f(1), ... f(count - 1) on `threads` threads, the caller's one of them, and on what is spare. What one of them
/// throws, as where memory ends, is thrown again here once all have ended.
template <class Item, class F>
std::vector<Item> in_parallel(std::size_t count, int threads, const F& f) {
  std::vector<Item> results(count);
  std::atomic<std::size_t> next = 0;
  std::exception_ptr thrown;
  std::once_flag first;
  SpareThreads spare;
  const auto work = [&] {
    SpareThreads* const outer = std::exchange(spare_threads, &spare);
    try {
      for (std::size_t k = next++; k < count; k = next++) results[k] = f(k);
    } catch (...) {
      std::call_once(first, [&] { thrown = std::current_exception(); });
      next = count;
    }
    spare_threads = outer;
    spare.give();
  };
  int taken = 0;
  while (std::cmp_less(threads + taken, count) && spare_threads != nullptr && spare_threads->take()) ++taken;
  std::vector<std::jthread> others;
  try {
    for (int other = 1; other < threads + taken && std::cmp_less(other, count); ++other) others.emplace_back(work);
  } catch (const std::system_error&) {
    // The system grants no more threads: those that there are do it.
  }
  work();
  others.clear();
  if (taken > 0) spare_threads->give(taken);
  if (thrown) std::rethrow_exception(thrown);
  return results;
}

}  // namespace sealwatch
