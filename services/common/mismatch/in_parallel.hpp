// Independent parts of an analysis on several threads; the results come in the order of the parts, so that sums over
// them do not depend on the number of threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace sealwatch::mismatch {

/// f(0), f(1), ... f(count - 1).
template <class Item, class F>
std::vector<Item> in_parallel(std::size_t count, int threads, const F& f) {
  std::vector<Item> results(count);
  std::atomic<std::size_t> next = 0;
  std::vector<std::jthread> workers;
  for (int worker = 0; worker < threads; ++worker)
    workers.emplace_back([&] {
      for (std::size_t k = next++; k < count; k = next++) results[k] = f(k);
    });
  workers.clear();
  return results;
}

}  // namespace sealwatch::mismatch
