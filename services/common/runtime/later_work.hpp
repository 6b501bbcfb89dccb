// What a layer leaves for later (port/layer.hpp), done in a thread of its own, one after another in the order given, so
// that a service goes on receiving while it computes. What was not done when this ends is not lost: its inputs are in
// the journal, unconsumed.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "sealwatch/port/layer.hpp"

namespace sealwatch {

class LaterWork {
 public:
  using Work = std::function<Conclusion()>;
  /// `on_done` is called by the thread whenever something is done.
  explicit LaterWork(std::function<void()> on_done) : on_done_(std::move(on_done)) {}
  /// Waits for the work that is running; leaves the rest.
  ~LaterWork();
  LaterWork(const LaterWork&) = delete;
  LaterWork& operator=(const LaterWork&) = delete;

  void add(Work work);
  /// What is done by now, in the order given. Raises what the work raised.
  [[nodiscard]] std::vector<Conclusion> take_done();
  /// Given and not yet taken back.
  [[nodiscard]] std::size_t open() const { return open_; }
  /// Until something is done, or the time is over.
  void wait(std::chrono::milliseconds timeout);

 private:
  void run();

  std::function<void()> on_done_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Work> waiting_;
  std::vector<Conclusion> done_;
  std::exception_ptr raised_;
  bool stopping_ = false;
  std::size_t open_ = 0;  ///< the owner's thread alone
  std::thread thread_;    ///< from the first work on
};

}  // namespace sealwatch
