#include "services/common/runtime/resend_queue.hpp"

#include <algorithm>

#include "services/common/runtime/stream_window.hpp"

namespace sealwatch {

std::uint64_t ResendQueue::waiting(const std::string* by) const {
  std::uint64_t count = 0;
  for (const Waiting& one : waiting_)
    if (by == nullptr || one.by == *by) count += one.range.last - one.range.first + 1;
  return count;
}

bool ResendQueue::add(Range wanted, std::uint64_t sent, const std::string& by, Time now) {
  wanted.first = std::max<std::uint64_t>(wanted.first, 1);
  wanted.last = std::min(wanted.last, sent);
  if (wanted.first > wanted.last) return false;
  wanted.last = wanted.first + std::min(wanted.last - wanted.first, stream_window(name_of(wanted.topic)) - 1);
  while (!granted_.empty() && now - granted_.front().at >= at_once_) granted_.pop_front();
  const bool had_it = std::ranges::any_of(granted_, [&](const Granted& one) {
    return one.by == by && one.range.topic == wanted.topic && one.range.first <= wanted.last &&
           wanted.first <= one.range.last;
  });
  const std::uint64_t count = wanted.last - wanted.first + 1;
  if (had_it || granted_.size() >= kMostWaiting || waiting(nullptr) + count > kMostWaiting ||
      waiting(&by) + count > kMostOfOne)
    return false;
  granted_.push_back({wanted, by, now});
  const auto touches = [&wanted](const Range& range) {  // numbers begin at 1
    return range.topic == wanted.topic && range.first - 1 <= wanted.last && wanted.first - 1 <= range.last;
  };
  for (auto one = waiting_.begin(); one != waiting_.end();) {
    if (touches(one->range)) {
      wanted.first = std::min(wanted.first, one->range.first);
      wanted.last = std::max(wanted.last, one->range.last);
      one = waiting_.erase(one);
    } else {
      ++one;
    }
  }
  waiting_.push_back({wanted, by});
  return true;
}

std::optional<ResendQueue::Range> ResendQueue::take(std::uint64_t most) {
  if (waiting_.empty()) return std::nullopt;
  Waiting taken = std::move(waiting_.front());
  waiting_.pop_front();
  if (taken.range.last - taken.range.first >= most) {
    const Range rest{taken.range.topic, taken.range.first + most, taken.range.last};
    taken.range.last = rest.first - 1;
    waiting_.push_back({rest, taken.by});
  }
  return taken.range;
}

}  // namespace sealwatch
