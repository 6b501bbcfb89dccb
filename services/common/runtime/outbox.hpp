// What was committed and not yet published, in the order of conclusion. A topic that the bus does not take now is tried
// again after a pause; others go on. Beyond a stream's window the newest are left out: they are in the journal, and
// their readers ask for what they miss.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>

#include "sealwatch/message/topics.hpp"

namespace sealwatch {

class Outbox {
 public:
  using Time = std::chrono::steady_clock::time_point;
  /// Pauses grow with the time since the bus took nothing: a topic that is stuck, where each try waits for up to 10 ms,
  /// costs its service a twentieth of its time.
  static constexpr std::chrono::milliseconds kShortestPause{5};
  static constexpr std::chrono::milliseconds kLongestPause{200};

  void add(Message stamped);
  /// Gives to `publish`, which says whether the bus took it, all that may go now.
  void send(Time now, const std::function<bool(Message&)>& publish);
  /// The bus did, or did not, take a message of this topic.
  void note(Topic topic, bool taken, Time now);
  /// Whether this topic was refused a moment ago.
  [[nodiscard]] bool pauses(Topic topic, Time now) const;
  /// Since when the bus has taken nothing of this topic.
  [[nodiscard]] std::optional<Time> refused_since(Topic topic) const;
  /// Sequence number of the first that waits.
  [[nodiscard]] std::optional<std::uint64_t> first(Topic topic) const;
  [[nodiscard]] bool empty() const { return waiting_.empty(); }

 private:
  struct Refusal {
    Time since;
    Time last;
  };
  std::deque<Message> waiting_;
  std::map<Topic, std::size_t> count_;
  std::map<Topic, Refusal> refusals_;
};

}  // namespace sealwatch
