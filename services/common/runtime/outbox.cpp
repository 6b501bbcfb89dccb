#include "services/common/runtime/outbox.hpp"

#include <algorithm>
#include <utility>

#include "services/common/runtime/stream_window.hpp"

namespace sealwatch {

void Outbox::add(Message stamped) {
  std::size_t& count = count_[topic_of(stamped)];
  // Past one that was left out nothing is added either: what waits of a stream has no gap.
  const auto last = std::find_if(waiting_.rbegin(), waiting_.rend(),
                                 [&](const Message& waiting) { return topic_of(waiting) == topic_of(stamped); });
  const bool follows =
      last == waiting_.rend() || header_of(*last).stream_sequence + 1 == header_of(stamped).stream_sequence;
  if (!follows || count >= stream_window(name_of(topic_of(stamped)))) return;
  ++count;
  waiting_.push_back(std::move(stamped));
}

void Outbox::send(Time now, const std::function<bool(Message&)>& publish) {
  for (auto next = waiting_.begin(); next != waiting_.end();) {
    const Topic topic = topic_of(*next);
    if (pauses(topic, now) || !publish(*next)) {
      ++next;
      continue;
    }
    --count_[topic];
    next = waiting_.erase(next);
  }
}

void Outbox::note(Topic topic, bool taken, Time now) {
  if (taken)
    refusals_.erase(topic);
  else
    refusals_.try_emplace(topic, Refusal{now, now}).first->second.last = now;
}

bool Outbox::pauses(Topic topic, Time now) const {
  const auto refusal = refusals_.find(topic);
  if (refusal == refusals_.end()) return false;
  const auto refused_for = refusal->second.last - refusal->second.since;
  return now < refusal->second.last + std::clamp<Time::duration>(refused_for, kShortestPause, kLongestPause);
}

std::optional<Outbox::Time> Outbox::refused_since(Topic topic) const {
  const auto refusal = refusals_.find(topic);
  return refusal == refusals_.end() ? std::nullopt : std::optional(refusal->second.since);
}

std::optional<std::uint64_t> Outbox::first(Topic topic) const {
  const auto found =
      std::ranges::find_if(waiting_, [topic](const Message& message) { return topic_of(message) == topic; });
  return found == waiting_.end() ? std::nullopt : std::optional(header_of(*found).stream_sequence);
}

}  // namespace sealwatch
