// The writing side of the stream protocol: what others asked to have again, served a bounded number at a time, whoever
// asks for whatever. Nobody needs the same again at once, and nobody has more than a share waiting: who asks for
// everything all the time gets each window about once a second, and holds up no other.
//
// Sending again takes half of the time at most, and a fifth while live messages come: each of them goes to all readers,
// and costs them their time as well. Who sends no heartbeat, as strangers do, gets a quarter of that, and holds up no
// reader that does.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
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
  enum class For { readers, strangers };
  /// For whom it is time to send more: readers first.
  [[nodiscard]] std::optional<For> next(Time now) const;
  /// The next at most `most` messages to send to those, topics in turn.
  [[nodiscard]] std::optional<Range> take(For whom, std::uint64_t most);
  /// Of what is taken next; none where nothing waits.
  [[nodiscard]] std::optional<Topic> next_topic(For whom) const;
  /// Sending what was taken for those took from `begin` to `end`.
  void note_sent(For whom, Time begin, Time end, bool beside_live);
  [[nodiscard]] bool empty() const { return waiting_.empty(); }

 private:
  struct Waiting {
    Range range;
    std::string by;  ///< who asked for it first; "": a stranger
  };
  struct Granted {
    Range range;
    std::string by;
    Time at;
  };
  [[nodiscard]] static For whom(const std::string& by) { return by.empty() ? For::strangers : For::readers; }
  [[nodiscard]] std::uint64_t waiting(const std::string* by) const;
  [[nodiscard]] std::deque<Waiting>::const_iterator first(For whom) const;

  std::chrono::milliseconds at_once_;
  std::deque<Waiting> waiting_;
  std::deque<Granted> granted_;  ///< a moment ago, in order
  std::map<For, Time> rests_until_;
};

}  // namespace sealwatch
