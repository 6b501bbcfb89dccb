// Until when a computation may go on: one object for all threads that take part, asked in every loop that may be long.
//
// A computation that was never told `passed` has not been changed by it: its result is that without a limit.
#pragma once

#include <atomic>
#include <chrono>
#include <stop_token>
#include <utility>

namespace sealwatch {

class Deadline {
 public:
  using Clock = std::chrono::steady_clock;

  /// None, until one is set. `cancel`: of whoever wants the result; what it calls off ends for good.
  explicit Deadline(std::stop_token cancel = {}) : cancel_(std::move(cancel)) {}

  /// From now on, later or earlier than before; infinite: none.
  void set_in(double seconds) {
    constexpr double kLongest_s = 1e9;
    const auto after = std::chrono::duration<double>(seconds < kLongest_s ? seconds : kLongest_s);
    until_ = (Clock::now() + std::chrono::duration_cast<Clock::duration>(after)).time_since_epoch().count();
  }

  /// Until it; infinite where there is none.
  [[nodiscard]] double left_s() const {
    const Clock::duration left(until_.load(std::memory_order_relaxed) - Clock::now().time_since_epoch().count());
    return std::chrono::duration<double>(left).count();
  }

  /// Whether work must end now; remembered in was_met().
  [[nodiscard]] bool passed() const {
    if (!cancelled() && Clock::now().time_since_epoch().count() < until_.load(std::memory_order_relaxed)) return false;
    met_.store(true, std::memory_order_relaxed);
    return true;
  }
  [[nodiscard]] bool cancelled() const { return cancel_.stop_requested(); }
  /// Whether it ever ended something.
  [[nodiscard]] bool was_met() const { return met_.load(std::memory_order_relaxed); }

 private:
  std::stop_token cancel_;
  std::atomic<Clock::rep> until_ = Clock::time_point::max().time_since_epoch().count();
  mutable std::atomic<bool> met_ = false;
};

/// Whether there is a deadline and it has passed.
[[nodiscard]] inline bool passed(const Deadline* deadline) { return deadline != nullptr && deadline->passed(); }

}  // namespace sealwatch
