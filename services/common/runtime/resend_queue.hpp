// The writing side of the stream protocol: what others asked to have again, served a bounded number at a time, and at
// most for half of the time, whoever asks for whatever. Nobody needs the same again at once, and nobody has more than a
// share waiting: who asks for everything all the time gets each window about once a second, and holds up no other.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "sealwatch/message/topics.hpp"

namespace sealwatch {

class ResendQueue {
 public:
  using Time = std::chrono::steady_clock::time_point;
  struct Range {
    Topic topic = Topic::raw_samples;
    std::uint64_t first = 0;
    std::uint64_t last = 0;
    friend bool operator==(const Range&, const Range&) = default;
  };
  /// A request counts for as many messages as readers ask for at a time (stream_window.hpp), and so many wait in all;
  /// what is left out is asked for again.
  static constexpr std::uint64_t kMostWaiting = 2048;
  static constexpr std::uint64_t kMostOfOne = 512;
  /// A reader that got no answer asks again after a second, the first time.
  static constexpr std::chrono::milliseconds kAtOnce{900};

  explicit ResendQueue(std::chrono::milliseconds at_once = kAtOnce) : at_once_(at_once) {}

  /// Adds what is not waiting already: several readers that miss the same messages are served once. Of a stream that
  /// goes up to `sent`, of which there may be less than was asked for. False when it is passed over.
  bool add(Range wanted, std::uint64_t sent, const std::string& by = {}, Time now = {});
  /// The next at most `most` messages to send, topics in turn.
  [[nodiscard]] std::optional<Range> take(std::uint64_t most);
  /// Whether it is time to send more: sending what was taken last took from `begin` to `end`.
  [[nodiscard]] bool may_send(Time now) const { return now >= rest_until_; }
  void note_sent(Time begin, Time end) { rest_until_ = end + (end - begin); }
  [[nodiscard]] bool empty() const { return waiting_.empty(); }
  /// Of what is taken next; there is something.
  [[nodiscard]] Topic next_topic() const { return waiting_.front().range.topic; }

 private:
  struct Waiting {
    Range range;
    std::string by;  ///< who asked for it first
  };
  struct Granted {
    Range range;
    std::string by;
    Time at;
  };
  [[nodiscard]] std::uint64_t waiting(const std::string* by) const;

  std::chrono::milliseconds at_once_;
  std::deque<Waiting> waiting_;
  std::deque<Granted> granted_;  ///< a moment ago, in order
  Time rest_until_{};
};

}  // namespace sealwatch
