#include "services/common/runtime/resend_queue.hpp"

#include <algorithm>

namespace sealwatch {

void ResendQueue::add(Range wanted) {
  if (wanted.first > wanted.last) return;
  const auto touches = [&wanted](const Range& range) {
    return range.topic == wanted.topic && range.first <= wanted.last + 1 && wanted.first <= range.last + 1;
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
