// How many acts that are refused stand in the audit trail, which keeps what it has for ever: without DDS Security any
// stranger can say what is refused, as often as he likes. The first of a day stand there in full; of those beyond there
// is an entry at the 1st, 2nd, 4th, 8th, ..., so that few entries tell how many were left out, whenever the process ends.
#pragma once

#include <bit>
#include <chrono>
#include <cstddef>

namespace sealwatch {

class RefusedActs {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr std::size_t kMostInFull = 64;

  /// Notes one more; whether it stands in full.
  bool admits(Time now) {
    constexpr std::chrono::hours kDay{24};
    if (count_ == 0 || now - since_ >= kDay) since_ = now, count_ = 0;
    return ++count_ <= kMostInFull;
  }
  /// Of the running day.
  [[nodiscard]] std::size_t left_out() const { return count_ > kMostInFull ? count_ - kMostInFull : 0; }
  [[nodiscard]] bool is_to_be_told() const { return std::has_single_bit(left_out()); }

 private:
  Time since_{};
  std::size_t count_ = 0;
};

}  // namespace sealwatch
