#include "services/common/runtime/resend_queue.hpp"

#include <algorithm>

#include "services/common/runtime/stream_window.hpp"

namespace sealwatch {
namespace {

/// So many times as long as sending took, the same are not sent to.
constexpr int kRest = 1;
constexpr int kRestBesideLive = 4;
constexpr int kRestOfStrangers = 4;

}  // namespace

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
    if (whom(one->by) == whom(by) && touches(one->range)) {
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

std::deque<ResendQueue::Waiting>::const_iterator ResendQueue::first(For whom) const {
  return std::ranges::find_if(waiting_, [whom](const Waiting& one) { return ResendQueue::whom(one.by) == whom; });
}

std::optional<ResendQueue::For> ResendQueue::next(Time now) const {
  for (const For whom : {For::readers, For::strangers}) {
    const auto rest = rests_until_.find(whom);
    const bool rests = rest != rests_until_.end() && now < rest->second;
    if (!rests && first(whom) != waiting_.end()) return whom;
  }
  return std::nullopt;
}

std::optional<Topic> ResendQueue::next_topic(For whom) const {
  const auto found = first(whom);
  return found == waiting_.end() ? std::nullopt : std::optional(found->range.topic);
}

std::optional<ResendQueue::Range> ResendQueue::take(For whom, std::uint64_t most) {
  const auto found = first(whom);
  if (found == waiting_.end()) return std::nullopt;
  Waiting taken = *found;
  waiting_.erase(found);
  if (taken.range.last - taken.range.first >= most) {
    const Range rest{taken.range.topic, taken.range.first + most, taken.range.last};
    taken.range.last = rest.first - 1;
    waiting_.push_back({rest, taken.by});
  }
  return taken.range;
}

void ResendQueue::note_sent(For whom, Time begin, Time end, bool beside_live) {
  const int rest = (beside_live ? kRestBesideLive : kRest) * (whom == For::strangers ? kRestOfStrangers : 1);
  rests_until_[whom] = end + rest * (end - begin);
}

}  // namespace sealwatch
