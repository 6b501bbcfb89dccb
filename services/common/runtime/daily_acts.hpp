// How many acts of a sort stand in the audit trail, which keeps what it has for ever: without DDS Security any stranger
// can say what he likes, as often as he likes. The first of a day stand there in full; of refused ones beyond there is an
// entry at the 1st, 2nd, 4th, 8th, ..., so that few entries tell how many were left out, whenever the process ends.
#pragma once

#include <bit>
#include <chrono>
#include <cstddef>

namespace sealwatch {

class DailyActs {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr std::size_t kMostInFull = 64;
  static constexpr std::chrono::hours kDay{24};

  /// Notes one more; whether it stands in full.
  bool admits(Time now) {
    if (is_another_day(now)) since_ = now, count_ = 0;
    return ++count_ <= kMostInFull;
  }
  /// Whether one more would not.
  [[nodiscard]] bool is_full(Time now) const { return count_ >= kMostInFull && !is_another_day(now); }
  /// Of the running day.
  [[nodiscard]] std::size_t left_out() const { return count_ > kMostInFull ? count_ - kMostInFull : 0; }
  [[nodiscard]] bool is_to_be_told() const { return std::has_single_bit(left_out()); }

 private:
  [[nodiscard]] bool is_another_day(Time now) const { return count_ == 0 || now - since_ >= kDay; }

  Time since_{};
  std::size_t count_ = 0;
};

}  // namespace sealwatch
