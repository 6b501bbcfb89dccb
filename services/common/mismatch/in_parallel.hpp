// Independent parts of an analysis on several threads; the results come in the order of the parts, so that sums over
// them do not depend on the number of threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace sealwatch::mismatch {

/// f(0), f(1), ... f(count - 1). What one of them throws, as where memory ends, is thrown again here once all have ended.
template <class Item, class F>
std::vector<Item> in_parallel(std::size_t count, int threads, const F& f) {
  std::vector<Item> results(count);
  std::atomic<std::size_t> next = 0;
  std::exception_ptr thrown;
  std::once_flag first;
  std::vector<std::jthread> workers;
  for (int worker = 0; worker < threads; ++worker)
    workers.emplace_back([&] {
      try {
        for (std::size_t k = next++; k < count; k = next++) results[k] = f(k);
      } catch (...) {
        std::call_once(first, [&] { thrown = std::current_exception(); });
        next = count;
      }
    });
  workers.clear();
  if (thrown) std::rethrow_exception(thrown);
  return results;
}

}  // namespace sealwatch::mismatch
