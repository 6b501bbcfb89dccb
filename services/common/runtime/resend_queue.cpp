#include "services/common/runtime/resend_queue.hpp"

#include <algorithm>

#include "services/common/runtime/stream_window.hpp"

namespace sealwatch {

std::uint64_t ResendQueue::waiting() const {
  std::uint64_t count = 0;
  for (const Range& range : waiting_) count += range.last - range.first + 1;
  return count;
}

void ResendQueue::add(Range wanted, std::uint64_t sent) {
  wanted.first = std::max<std::uint64_t>(wanted.first, 1);
  wanted.last = std::min(wanted.last, sent);
  if (wanted.first > wanted.last) return;
  wanted.last = wanted.first + std::min(wanted.last - wanted.first, stream_window(name_of(wanted.topic)) - 1);
  if (waiting() + (wanted.last - wanted.first + 1) > kMostWaiting) return;
  const auto touches = [&wanted](const Range& range) {  // numbers begin at 1
    return range.topic == wanted.topic && range.first - 1 <= wanted.last && wanted.first - 1 <= range.last;
  };
  for (auto range = waiting_.begin(); range != waiting_.end();) {
    if (touches(*range)) {
      wanted.first = std::min(wanted.first, range->first);
      wanted.last = std::max(wanted.last, range->last);
      range = waiting_.erase(range);
    } else {
      ++range;
    }
  }
  waiting_.push_back(wanted);
}

std::optional<ResendQueue::Range> ResendQueue::take(std::uint64_t most) {
  if (waiting_.empty()) return std::nullopt;
  Range taken = waiting_.front();
  waiting_.pop_front();
  if (taken.last - taken.first >= most) {
    const Range rest{taken.topic, taken.first + most, taken.last};
    taken.last = rest.first - 1;
    waiting_.push_back(rest);
  }
  return taken;
}

}  // namespace sealwatch
