// Messages that wait for another one about the same test, in the order of receipt.
//
// A writer's stream brings an asset's tests in their order, on each topic: one whose other half is not there when that of
// a later test is, was overtaken. It may be forged, or its other half set aside: it holds up no later test, waits on in
// case that is tried again, and of those that were overtaken only the last few do.
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <string>
#include <utility>

#include "sealwatch/port/layer.hpp"

namespace sealwatch {

template <class Half>
class Halves {
 public:
  static constexpr std::size_t kMostOvertaken = 16;

  void add(const Half& half) { waiting_.push_back(half); }
  [[nodiscard]] std::size_t size() const { return waiting_.size(); }
  [[nodiscard]] const Half& at(std::size_t place) const { return waiting_[place]; }
  /// How many wait in vain, as it seems: the first ones.
  [[nodiscard]] std::size_t overtaken() const { return overtaken_; }
  [[nodiscard]] const Half* find(const std::string& pst_id) const {
    const auto found = std::ranges::find_if(waiting_, [&](const Half& half) { return half.header.pst_id == pst_id; });
    return found == waiting_.end() ? nullptr : &*found;
  }
  /// The one at that place waits no longer, and has overtaken those before it.
  Half take(std::size_t place, Conclusion& conclusion) {
    Half half = std::move(waiting_[place]);
    waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(place));
    overtaken_ = place < overtaken_ ? overtaken_ - 1 : place;
    for (; overtaken_ > kMostOvertaken; --overtaken_) {
      const Header& header = waiting_.front().header;
      conclusion.consumed.push_back(header.message_id);
      std::string why = "what else belongs to test " + header.pst_id + " did not come, and that of later tests did";
      conclusion.refused.push_back({std::move(waiting_.front()), std::move(why)});
      waiting_.pop_front();
    }
    return half;
  }
  Half take(const std::string& pst_id, Conclusion& conclusion) {
    return take(static_cast<std::size_t>(
                    std::ranges::find_if(waiting_, [&](const Half& half) { return half.header.pst_id == pst_id; }) -
                    waiting_.begin()),
                conclusion);
  }

 private:
  std::deque<Half> waiting_;
  std::size_t overtaken_ = 0;
};

}  // namespace sealwatch
